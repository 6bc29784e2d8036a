//! The Node-RED flow uses only published topics and fields.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use crate::broker::{Mosquitto, PATIENCE};
use crate::mqtt::{run, start};

const FLOW: &str = include_str!("../../dashboard/node-red.json");

/// Fields of a message that a node reads: for example `payload.stiffness_kN_per_mm`, or the columns of a table.
fn fields_of(node: &Value) -> Vec<String> {
    let rules = node["rules"].as_array().into_iter().flatten();
    let read = rules
        .filter(|rule| rule["tot"] == "msg")
        .map(|rule| &rule["to"]);
    let columns = node["columns"].as_array().into_iter().flatten();
    let paths = read.chain([&node["property"]]).filter_map(Value::as_str);
    let mut fields: Vec<String> = paths
        .filter_map(|path| path.strip_prefix("payload."))
        .map(str::to_owned)
        .collect();
    fields.extend(columns.map(|column| column["key"].as_str().unwrap().to_owned()));
    fields
}

/// The nodes after `node`, up to those that replace the message's payload.
fn behind<'a>(nodes: &BTreeMap<&str, &'a Value>, node: &Value, found: &mut Vec<&'a Value>) {
    for next in node["wires"].as_array().into_iter().flatten() {
        for id in next.as_array().unwrap() {
            let next = nodes[id.as_str().unwrap()];
            found.push(next);
            if next["type"] != "change" {
                behind(nodes, next, found);
            }
        }
    }
}

#[test]
fn the_flow_reads_what_is_published() {
    let nodes: Vec<Value> = serde_json::from_str(FLOW).unwrap();
    let by_id: BTreeMap<&str, &Value> = nodes
        .iter()
        .map(|node| (node["id"].as_str().unwrap(), node))
        .collect();
    assert_eq!(by_id.len(), nodes.len(), "an id stands there twice");
    // The nodes that others refer to exist.
    for node in &nodes {
        for field in ["z", "broker", "group", "page", "ui", "theme"] {
            if let Some(id) = node[field].as_str()
                && node["type"] != "mqtt-broker"
            {
                assert!(by_id.contains_key(id), "{field} of {}", node["id"]);
            }
        }
    }
    let Some(broker) = Mosquitto::start(None) else {
        return;
    };
    let mut publisher = start(broker.port(), "/rig-7");
    publisher.wait_until_connected(PATIENCE).unwrap();
    let mut heard = broker.subscribe(None);
    heard.until("waiting");
    run(&mut publisher);
    publisher.close(PATIENCE);
    let messages = heard.until("finished");

    let mut heads = BTreeSet::new();
    let mut used = 0;
    for head in nodes.iter().filter(|node| node["type"] == "mqtt in") {
        let topic = head["topic"].as_str().unwrap().replace('+', "rig-7");
        let found: Vec<_> = messages.iter().filter(|m| m.topic == topic).collect();
        assert!(!found.is_empty(), "nothing is published at {topic}");
        let mut readers = Vec::new();
        behind(&by_id, head, &mut readers);
        for field in readers.iter().flat_map(|node| fields_of(node)) {
            let pointer = format!("/{}", field.replace('.', "/"));
            let is_there = found.iter().all(|m| m.payload.pointer(&pointer).is_some());
            assert!(is_there, "{topic} has no {field}: {:?}", found[0].payload);
            used += 1;
        }
        heads.insert(topic);
    }
    // It shows every available topic.
    let heard: BTreeSet<String> = messages.iter().map(|m| m.topic.clone()).collect();
    assert_eq!(heads, heard);
    assert!(used > 15, "{used}");
}

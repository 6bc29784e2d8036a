//! The publisher with a real broker.

use std::time::Duration;

use mesh_damper_live::{About, Broker, CycleResult, Event, Listener, MqttPublisher, Sample, State};
use serde_json::Value;

use crate::broker::{Mosquitto, PATIENCE, free_port};

pub fn start(port: u16, rest: &str) -> MqttPublisher {
    let broker: Broker = format!("mqtt://127.0.0.1:{port}{rest}").parse().unwrap();
    let about = About {
        title: "a test".into(),
        sample_rate: 1000.0,
        ..About::default()
    };
    MqttPublisher::start(&broker, &about)
}

/// A short test with everything in it.
pub fn run(publisher: &mut MqttPublisher) {
    publisher.state(&State::Running);
    for tick in 0..128 {
        let value = tick as f32 / 128.0;
        publisher.sample(&Sample {
            time: f64::from(tick) / 1000.0,
            displacement: value,
            force: -2.0 * value,
            law_force: 0.0,
        });
    }
    for cycle in 0..200 {
        publisher.cycle(&CycleResult {
            time: 0.128,
            cycle,
            stiffness: 1.5,
            loss_factor: 0.25,
            temperature: 23.5,
            ..CycleResult::default()
        });
    }
    publisher.event(&Event {
        time: 0.1,
        cause: "WireBreakage".into(),
        fault: true,
        text: "wire breakage".into(),
        ..Event::default()
    });
    publisher.state(&State::Finished { time: 0.128 });
}

#[test]
fn a_broker_gets_status_health_cycles_and_events() {
    let Some(broker) = Mosquitto::start(None) else {
        return;
    };
    let mut publisher = start(broker.port(), "/rig-7");
    publisher.wait_until_connected(PATIENCE).unwrap();
    let mut heard = broker.subscribe(None);
    // The subscriber is ready when it has the retained messages.
    heard.until("waiting");
    run(&mut publisher);
    let delivery = publisher.close(PATIENCE);
    let messages = heard.until("finished");
    assert_eq!(delivery.dropped, 0);
    let of = |name: &str| -> Vec<&Value> {
        let topic = format!("mesh-damper/rig-7/{name}");
        let messages = messages.iter().filter(|message| message.topic == topic);
        messages.map(|message| &message.payload).collect()
    };
    let cycles = of("cycle");
    assert_eq!(cycles.len(), 200);
    for (number, cycle) in cycles.iter().enumerate() {
        assert_eq!(cycle["cycle"], number);
        assert_eq!(cycle["stiffness_kN_per_mm"], 1.5);
        assert_eq!(cycle["loss_factor"], 0.25);
        assert_eq!(cycle["temperature_degC"], 23.5);
        assert_eq!(cycle["time_s"], 0.128);
    }
    assert_eq!(of("event")[0]["cause"], "WireBreakage");
    assert_eq!(of("status").last().unwrap()["time_s"], 0.128);
    assert_eq!(of("status").last().unwrap()["about"]["title"], "a test");

    // A later subscriber still receives the final state and the last health message.
    let mut later = broker.subscribe(None);
    let both = [later.next(), later.next()];
    assert!(both.iter().all(|message| message.retained), "{both:?}");
    let retained = |name: &str| {
        let found = both.iter().find(|message| message.topic.ends_with(name));
        &found.unwrap().payload
    };
    assert_eq!(retained("/status")["state"], "finished");
    let health = retained("/health");
    assert_eq!(health["state"], "finished");
    assert_eq!(health["samples"], 128);
    assert_eq!(health["temperature_degC"], 23.5);
    assert_eq!(health["faults"][0], "WireBreakage");
    assert_eq!(health["messages_dropped"], 0);
}

/// A killed process sends nothing more. For the broker, a dropped publisher looks the same.
#[test]
fn the_last_will_says_offline() {
    let Some(broker) = Mosquitto::start(None) else {
        return;
    };
    let mut publisher = start(broker.port(), "");
    publisher.wait_until_connected(PATIENCE).unwrap();
    let mut heard = broker.subscribe(None);
    publisher.state(&State::Running);
    heard.until("running");
    drop(publisher);
    let last = heard.until("offline").pop().unwrap();
    assert_eq!(last.topic, "mesh-damper/rig/status");
    assert!(broker.subscribe(None).next().retained);
}

/// The broker stops and returns in the middle of a test. Messages from that time arrive later, all and in order, and nobody had to wait.
#[test]
fn what_happens_without_a_broker_is_sent_once_there_is_one() {
    let Some(mut broker) = Mosquitto::start(None) else {
        return;
    };
    let mut publisher = start(broker.port(), "");
    publisher.wait_until_connected(PATIENCE).unwrap();
    let cycle = |publisher: &mut MqttPublisher, cycle| {
        publisher.cycle(&CycleResult {
            cycle,
            ..CycleResult::default()
        });
    };
    publisher.state(&State::Running);
    // The broker may return to the publisher before it returns to the subscriber: it keeps what comes in between.
    const SUBSCRIBER: &str = "log";
    broker.subscribe_as(SUBSCRIBER).until("running");
    broker.restart(|| (0..100).for_each(|number| cycle(&mut publisher, number)));
    let mut heard = broker.subscribe_as(SUBSCRIBER);
    publisher.state(&State::Finished { time: 1.0 });
    let delivery = publisher.close(PATIENCE);
    assert_eq!(delivery.dropped, 0);
    let messages = heard.until("finished");
    let mut cycles: Vec<u64> = messages
        .iter()
        .filter(|message| message.topic.ends_with("/cycle"))
        .map(|message| message.payload["cycle"].as_u64().unwrap())
        .collect();
    // At least once, as the quality of service promises: a message whose confirmation is lost arrives again.
    cycles.dedup();
    assert!(cycles.iter().copied().eq(0..100), "{cycles:?}");
}

#[test]
fn without_a_broker_memory_is_bounded_and_the_end_comes() {
    let port = free_port();
    let mut publisher = start(port, "");
    assert!(publisher.wait_until_connected(PATIENCE).is_err());
    for number in 0..20_000 {
        publisher.cycle(&CycleResult {
            cycle: number,
            ..CycleResult::default()
        });
    }
    let delivery = publisher.close(Duration::from_millis(1));
    assert_eq!(delivery.delivered, 0);
    // All of them, including the statuses and the last health message.
    assert_eq!(delivery.dropped, 20_000 + 2);
}

#[test]
fn user_and_password_are_those_of_the_url() {
    let login = Some(("lab", "p@ss/word"));
    let Some(broker) = Mosquitto::start(login) else {
        return;
    };
    let wrong = format!("mqtt://lab:wrong@127.0.0.1:{}", broker.port());
    let about = About::default();
    let publisher = MqttPublisher::start(&wrong.parse().unwrap(), &about);
    let said = publisher.wait_until_connected(PATIENCE).unwrap_err();
    assert!(
        said.contains("NotAuthorized") || said.contains("BadUserNamePassword"),
        "{said}"
    );
    let right = format!("mqtt://lab:p%40ss%2Fword@127.0.0.1:{}", broker.port());
    let publisher = MqttPublisher::start(&right.parse().unwrap(), &about);
    publisher.wait_until_connected(PATIENCE).unwrap();
    assert_eq!(publisher.close(PATIENCE).dropped, 0);
    let last = broker.subscribe(login).next();
    assert_eq!(last.payload["state"], "waiting");
}

//! Columns as MCAP, for Foxglove.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::Arc;

use mcap::records::Metadata;
use mcap::{Channel, McapResult, Message, Schema, WriteOptions};
use serde_json::{Map, Value, json};

use super::{Column, Unwritten};
use crate::channel::Channel as Quantity;

const TOPIC: &str = "/recording";

/// A file with one message per sample on the topic `/recording`: a JSON object with one field per column, as its schema says. A
/// plot takes `/recording.force_kN`. The times of the messages are those of the samples, counted from the first sample if that is
/// below 0.
pub(super) fn write(comments: &[String], columns: &[Column<'_>]) -> Result<Vec<u8>, Unwritten> {
    written(comments, columns).map_err(Unwritten::by)
}

fn written(comments: &[String], columns: &[Column<'_>]) -> McapResult<Vec<u8>> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = WriteOptions::new()
        .compression(Some(mcap::Compression::Zstd))
        .library("mesh-damper")
        .create(&mut file)?;
    let fields = columns.iter().map(|column| {
        let described = column.unit.map(|unit| format!("in {unit}"));
        let field = json!({"type": "number", "description": described.unwrap_or_default()});
        (column.name.to_owned(), field)
    });
    let properties: Map<String, Value> = fields.collect();
    let schema = json!({"type": "object", "title": "recording", "properties": properties});
    let channel = Channel {
        id: 1,
        topic: TOPIC.into(),
        schema: Some(Arc::new(Schema {
            id: 1,
            name: "recording".into(),
            encoding: "jsonschema".into(),
            data: Cow::Owned(schema.to_string().into_bytes()),
        })),
        message_encoding: "json".into(),
        metadata: BTreeMap::new(),
    };
    let channel = Arc::new(channel);
    let times = nanoseconds(columns);
    for (index, log_time) in times.into_iter().enumerate() {
        let fields = columns.iter().filter_map(|column| {
            // JSON has no number for a value that was not measured.
            let value = column.values.get(index).filter(|value| value.is_finite())?;
            Some((column.name.to_owned(), json!(value)))
        });
        let data: Map<String, Value> = fields.collect();
        writer.write(&Message {
            channel: channel.clone(),
            sequence: index as u32,
            log_time,
            publish_time: log_time,
            data: Cow::Owned(Value::Object(data).to_string().into_bytes()),
        })?;
    }
    let numbered = comments.iter().enumerate();
    let metadata: BTreeMap<String, String> = numbered
        .map(|(index, line)| (format!("{:03}", index + 1), line.clone()))
        .collect();
    if !metadata.is_empty() {
        writer.write_metadata(&Metadata {
            name: "comments".into(),
            metadata,
        })?;
    }
    writer.finish()?;
    drop(writer);
    Ok(file.into_inner())
}

/// The times of the samples, ns; the sample numbers in ms if no column has times.
fn nanoseconds(columns: &[Column<'_>]) -> Vec<u64> {
    let units = Quantity::Time.units().iter();
    let time = columns.iter().find_map(|column| {
        let symbol = column.name.strip_prefix("time_")?;
        let unit = units.clone().find(|unit| unit.symbol == symbol)?;
        Some((column.values, unit))
    });
    let rows = columns.first().map_or(0, |column| column.values.len());
    match time {
        Some((values, unit)) => {
            let seconds = values.iter().map(|value| unit.to_code(*value));
            let first = seconds.clone().next().unwrap_or_default().min(0.0);
            seconds
                .map(|second| ((second - first) * 1e9).round() as u64)
                .collect()
        }
        None => (0..rows as u64).map(|row| row * 1_000_000).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_sample_is_a_message_that_its_schema_describes() {
        let time = [-0.5, 0.0, 0.001];
        let force = [1.25, f64::NAN, -3.5];
        let column = |name, unit, values| Column { name, unit, values };
        let columns = [
            column("time_s", Some("s"), &time),
            column("force_kN", Some("kN"), &force),
        ];
        let file = write(&["specimen: D1".into()], &columns).unwrap();
        let messages: Vec<_> = mcap::MessageStream::new(&file)
            .unwrap()
            .collect::<Result<_, _>>()
            .unwrap();
        assert_eq!(messages.len(), 3);
        let schema = messages[0].channel.schema.clone().unwrap();
        let schema: Value = serde_json::from_slice(&schema.data).unwrap();
        assert_eq!(schema["properties"]["force_kN"]["description"], "in kN");
        let value =
            |index: usize| -> Value { serde_json::from_slice(&messages[index].data).unwrap() };
        for (index, (time, nanoseconds)) in [(-0.5, 0), (0.0, 500_000_000), (0.001, 501_000_000)]
            .iter()
            .enumerate()
        {
            assert_eq!(messages[index].log_time, *nanoseconds);
            assert_eq!(value(index)["time_s"], json!(time));
        }
        assert_eq!(value(0)["force_kN"], json!(1.25));
        assert_eq!(value(1).get("force_kN"), None);
        assert_eq!(messages[0].channel.topic, TOPIC);
        let summary = mcap::Summary::read(&file).unwrap().unwrap();
        assert_eq!(summary.metadata_indexes.len(), 1);
        assert_eq!(summary.stats.unwrap().message_count, 3);
    }
}

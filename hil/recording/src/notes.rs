//! Notes about many recordings: one sentence for all that share it.

use std::collections::HashSet;

/// Words that differ between one and several.
const PLURALS: [(&str, &str); 4] = [
    ("samples", "sample"),
    ("stretches", "stretch"),
    ("gaps", "gap"),
    ("were", "was"),
];

/// The `notes`, each with those that say the same about another of the `recordings`, as one sentence. A note about a recording begins
/// with its name and a colon. Two notes say the same if they differ in numbers only; the sentence is that with the largest first number,
/// and says how many recordings share it, and which.
pub fn shared<'n>(
    recordings: impl IntoIterator<Item = &'n str>,
    notes: impl IntoIterator<Item = String>,
) -> Vec<String> {
    let mut names: Vec<&str> = recordings.into_iter().collect();
    // `a: b` before `a`.
    names.sort_by_key(|name| std::cmp::Reverse(name.len()));
    let mut kinds: Vec<(String, Vec<Note>)> = Vec::new();
    for note in notes {
        let about = names.iter().find_map(|name| {
            let text = note.strip_prefix(name)?.strip_prefix(": ")?;
            Some(Note {
                recording: (*name).to_owned(),
                text: text.to_owned(),
            })
        });
        let (key, note) = match about {
            Some(about) => (kind(&about.text), about),
            None => (
                note.clone(),
                Note {
                    recording: String::new(),
                    text: note,
                },
            ),
        };
        let mut of_kind = kinds.iter_mut().filter(|(known, _)| *known == key);
        // A second note of the kind about the same recording, as for the other limit of a channel, is another sentence.
        let place = of_kind.find(|(_, alike)| {
            let mut names = alike.iter().map(|one| &one.recording);
            alike.contains(&note) || !names.any(|name| *name == note.recording)
        });
        match place {
            Some((_, alike)) if alike.contains(&note) => {}
            Some((_, alike)) => alike.push(note),
            None => kinds.push((key, vec![note])),
        }
    }
    kinds
        .into_iter()
        .map(|(_, alike)| sentence(alike))
        .collect()
}

#[derive(PartialEq)]
struct Note {
    /// Empty for a note about none.
    recording: String,
    text: String,
}

impl Note {
    /// Its first number without the sign; 0 without one.
    fn size(&self) -> f64 {
        let is_of_number = |c: char| c.is_ascii_digit() || c == '.';
        let mut words = self.text.split(|c: char| !is_of_number(c));
        words
            .find_map(|word| word.parse::<f64>().ok())
            .unwrap_or(0.0)
    }
}

fn sentence(mut alike: Vec<Note>) -> String {
    alike.sort_by(|a, b| b.size().total_cmp(&a.size()));
    let (worst, others) = alike.split_first().expect("a kind has a note");
    if worst.recording.is_empty() {
        return worst.text.clone();
    }
    if others.is_empty() {
        return format!("{}: {}", worst.recording, worst.text);
    }
    let file = |note: &Note| {
        let name = &note.recording;
        name.rsplit(['/', '\\']).next().unwrap_or(name).to_owned()
    };
    let files: HashSet<String> = alike.iter().map(file).collect();
    let short = |note: &Note| match files.len() == alike.len() {
        true => file(note),
        false => note.recording.clone(),
    };
    let which: Vec<String> = alike.iter().map(short).collect();
    let most = match others.iter().all(|other| other.text == worst.text) {
        true => "",
        false => ", the first the most",
    };
    format!(
        "{} — in {} recordings{most}: {}",
        worst.text,
        alike.len(),
        which.join(", ")
    )
}

/// A note without its numbers.
fn kind(text: &str) -> String {
    let mut kind = String::new();
    for c in text.chars() {
        let is_of_number = c.is_ascii_digit() || matches!(c, '.' | '-' | '−' | '+');
        match (is_of_number, kind.ends_with('#')) {
            (true, true) => {}
            (true, false) => kind.push('#'),
            (false, _) => kind.push(c),
        }
    }
    PLURALS
        .iter()
        .fold(kind, |kind, (many, one)| kind.replace(many, one))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_many_recordings_share_is_one_sentence_with_the_worst_first() {
        let notes = [
            "runs/b.csv: spikes in the force: 1 sample, the largest 4.0 times the spread; left out",
            "the law is worse",
            "runs/a.csv: spikes in the force: 12 samples, the largest 9.5 times the spread; left out",
            "runs/c.csv: force is read from column \"Load\" in N",
            "runs/a.csv: force is read from column \"Load\" in N",
            "runs/b.csv: clipping of the force at 2.0 kN: 3 samples; left out",
            "the law is worse",
        ];
        let names = ["runs/a.csv", "runs/b.csv", "runs/c.csv"];
        assert_eq!(
            shared(names, notes.map(str::to_owned)),
            [
                "spikes in the force: 12 samples, the largest 9.5 times the spread; left out — in 2 recordings, the first the most: \
                 a.csv, b.csv",
                "the law is worse",
                "force is read from column \"Load\" in N — in 2 recordings: c.csv, a.csv",
                "runs/b.csv: clipping of the force at 2.0 kN: 3 samples; left out",
            ]
        );
    }

    #[test]
    fn two_notes_about_one_recording_stay_two() {
        let notes = [
            "a.csv: clipping at 2.0 kN",
            "a.csv: clipping at -2.0 kN",
            "b.csv: clipping at 2.1 kN",
        ];
        assert_eq!(
            shared(["a.csv", "b.csv"], notes.map(str::to_owned)),
            [
                "clipping at 2.1 kN — in 2 recordings, the first the most: b.csv, a.csv",
                "a.csv: clipping at -2.0 kN",
            ]
        );
    }

    #[test]
    fn recordings_of_one_file_name_are_named_in_full() {
        let names = ["1/a.csv", "2/a.csv"];
        let notes = names.map(|name| format!("{name}: hum"));
        assert_eq!(
            shared(names, notes),
            ["hum — in 2 recordings: 1/a.csv, 2/a.csv"]
        );
    }
}

//! The server, tested with the requests of browsers and other clients.

use std::collections::BTreeSet;
use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use mesh_damper_live::{About, CycleResult, Event, Limits, Listener, LivePage, Sample, State};
use serde_json::Value;
use tungstenite::client::IntoClientRequest as _;
use tungstenite::{Error, Message, WebSocket};

/// Longer than any step here, so that a hanging test ends.
const PATIENCE: Duration = Duration::from_secs(60);

fn page(rate: f64, limits: Limits) -> (LivePage, SocketAddr) {
    let about = About {
        title: "a test".into(),
        sample_rate: rate,
        ..About::default()
    };
    let page = LivePage::start(0, about, limits).unwrap();
    let address = page.address();
    let place = address.trim_start_matches("http://").trim_end_matches('/');
    let place = place.parse().unwrap();
    (page, place)
}

fn ask(place: SocketAddr, request: &str) -> String {
    let mut stream = TcpStream::connect(place).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    String::from_utf8_lossy(&answer).into_owned()
}

fn get(place: SocketAddr, path: &str) -> String {
    ask(
        place,
        &format!("GET {path} HTTP/1.1\r\nHost: {place}\r\n\r\n"),
    )
}

/// The status of a refused WebSocket, or the WebSocket.
fn open(
    place: SocketAddr,
    host: &str,
    origin: Option<&str>,
) -> Result<WebSocket<TcpStream>, Box<Error>> {
    let mut request = format!("ws://{place}/live").into_client_request().unwrap();
    let headers = request.headers_mut();
    headers.insert("Host", host.parse().unwrap());
    if let Some(origin) = origin {
        headers.insert("Origin", origin.parse().unwrap());
    }
    let stream = TcpStream::connect(place).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    match tungstenite::client(request, stream) {
        Ok((socket, _)) => Ok(socket),
        Err(tungstenite::HandshakeError::Failure(error)) => Err(error.into()),
        Err(tungstenite::HandshakeError::Interrupted(_)) => panic!("it does not answer"),
    }
}

fn connect(place: SocketAddr) -> WebSocket<TcpStream> {
    let host = place.to_string();
    open(place, &host, Some(&format!("http://{host}"))).unwrap()
}

/// The received data, by column.
#[derive(Default)]
struct Received {
    samples: Vec<[f64; 4]>,
    cycles: Vec<Vec<f64>>,
    texts: Vec<Value>,
    missed: u64,
    messages: usize,
}

impl Received {
    /// Everything until the server closes the connection.
    fn all(socket: &mut WebSocket<TcpStream>) -> Self {
        let mut received = Self::default();
        loop {
            match socket.read() {
                Ok(Message::Text(text)) => {
                    received.texts.push(serde_json::from_str(&text).unwrap());
                }
                Ok(Message::Binary(bytes)) => received.take(&bytes),
                Ok(_) => {}
                Err(Error::ConnectionClosed) => return received,
                Err(error) => panic!("{error}"),
            }
        }
    }

    fn take(&mut self, bytes: &[u8]) {
        self.messages += 1;
        assert_eq!(&bytes[..3], b"MD\x01");
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let (rows, columns) = (word(4) as usize, word(8) as usize);
        self.missed = word(12).into();
        let start = f64::from_le_bytes(bytes[16..24].try_into().unwrap());
        assert_eq!(bytes.len(), 24 + 4 * rows * columns);
        let value = |row: usize, column: usize| {
            f64::from(f32::from_bits(word(24 + 4 * (column * rows + row))))
        };
        for row in 0..rows {
            let mut values: Vec<f64> = (0..columns).map(|column| value(row, column)).collect();
            values[0] += start;
            match bytes[3] {
                1 => self.samples.push(values.try_into().unwrap()),
                2 => self.cycles.push(values),
                kind => panic!("kind {kind}"),
            }
        }
    }

    fn state(&self) -> &Value {
        &self.texts.last().unwrap()["state"]
    }
}

/// A sine of 0.1 mm and 5 Hz at `rate` Hz.
fn sine(tick: u64, rate: f64) -> Sample {
    let time = tick as f64 / rate;
    let displacement = (0.1 * (std::f64::consts::TAU * 5.0 * time).sin()) as f32;
    Sample {
        time,
        displacement,
        force: 2.0 * displacement,
        law_force: 3.0 * displacement,
    }
}

#[test]
fn the_page_comes_with_all_that_it_names() {
    let (_page, place) = page(1000.0, Limits::default());
    let html = get(place, "/");
    assert!(html.starts_with("HTTP/1.1 200 OK\r\n"), "{html}");
    assert!(html.contains("Content-Security-Policy: default-src 'none'"));
    // Its own files, and the imports of its scripts.
    let mut left = vec![html];
    let mut seen = BTreeSet::new();
    while let Some(text) = left.pop() {
        for (before, after) in [("src=\"/", "\""), ("href=\"/", "\""), ("from \"./", "\"")] {
            for part in text.split(before).skip(1) {
                let name = part.split(after).next().unwrap();
                let path = match before {
                    "from \"./" => format!("/js/{name}"),
                    _ => format!("/{name}"),
                };
                if !seen.insert(path.clone()) {
                    continue;
                }
                let answer = get(place, &path);
                let is_there = answer.starts_with("HTTP/1.1 200 OK\r\n");
                assert!(is_there, "{path}: {answer}");
                if path.starts_with("/js/") {
                    left.push(answer);
                }
            }
        }
    }
    assert!(seen.len() > 12, "{seen:?}");
    // Every existing script is used.
    let scripts = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/page/js")).unwrap();
    for script in scripts {
        let name = script.unwrap().file_name().into_string().unwrap();
        assert!(seen.contains(&format!("/js/{name}")), "{name}");
    }
}

#[test]
fn what_is_no_request_of_the_page_is_refused() {
    let (_page, place) = page(1000.0, Limits::default());
    let status = |request: &str| ask(place, request)[9..12].to_owned();
    let host = format!("Host: {place}");
    assert_eq!(
        status(&format!("GET /etc/passwd HTTP/1.1\r\n{host}\r\n\r\n")),
        "404"
    );
    assert_eq!(
        status(&format!("GET /../Cargo.toml HTTP/1.1\r\n{host}\r\n\r\n")),
        "404"
    );
    assert_eq!(status(&format!("POST / HTTP/1.1\r\n{host}\r\n\r\n")), "405");
    assert_eq!(
        status(&format!("GET /live HTTP/1.1\r\n{host}\r\n\r\n")),
        "426"
    );
    // Another name that points here, and two of them.
    assert_eq!(
        status("GET / HTTP/1.1\r\nHost: evil.example:80\r\n\r\n"),
        "421"
    );
    assert_eq!(status("GET / HTTP/1.1\r\n\r\n"), "421");
    assert_eq!(
        status(&format!("GET / HTTP/1.1\r\n{host}\r\n{host}\r\n\r\n")),
        "400"
    );
    assert_eq!(status("nonsense\r\n\r\n"), "400");
    let long = format!("GET / HTTP/1.1\r\nX: {}", "x".repeat(9 << 10));
    assert_eq!(status(&long), "400");
}

#[test]
fn only_this_page_opens_the_socket() {
    let (page, place) = page(1000.0, Limits::default());
    let host = place.to_string();
    let port = place.port();
    let refused = |host: &str, origin: &str| match open(place, host, Some(origin)) {
        Err(error) => match *error {
            Error::Http(answer) => answer.status().as_u16(),
            error => panic!("{error}"),
        },
        Ok(_) => 101,
    };
    assert_eq!(refused(&host, "http://evil.example"), 403);
    assert_eq!(refused(&host, "null"), 403);
    assert_eq!(refused(&host, &format!("https://{host}")), 403);
    assert_eq!(refused(&host, "http://127.0.0.1:1"), 403);
    let evil = format!("evil.example:{port}");
    assert_eq!(refused(&evil, &format!("http://{evil}")), 421);
    assert_eq!(page.viewers_so_far(), 0);
    // The page itself, also through a tunnel from another port, and a program that is no browser.
    assert_eq!(refused(&host, &format!("http://{host}")), 101);
    assert_eq!(refused("localhost:9000", "http://localhost:9000"), 101);
    assert!(open(place, &host, None).is_ok());
}

#[test]
fn a_page_gets_the_sine_with_its_peaks_the_cycles_and_the_end() {
    let rate = 10_000.0;
    let (mut page, place) = page(rate, Limits::default());
    let mut socket = connect(place);
    page.state(&State::Running);
    let ticks = 30_000;
    for tick in 0..ticks {
        page.sample(&sine(tick, rate));
        if tick % 2000 == 1999 {
            page.cycle(&CycleResult {
                time: tick as f64 / rate,
                cycle: (tick / 2000) as u32,
                stiffness: 2.0,
                ..CycleResult::default()
            });
        }
    }
    page.event(&Event {
        text: "it is over".into(),
        ..Event::default()
    });
    page.state(&State::Finished { time: 3.0 });
    let reader = std::thread::spawn(move || Received::all(&mut socket));
    let seen = page.close(PATIENCE);
    let received = reader.join().unwrap();

    assert_eq!((received.missed, seen.missed), (0, 0));
    assert_eq!(received.samples.len() as u64, seen.samples);
    // Of 20 ticks, two to six are kept.
    let buckets = ticks as usize / 20;
    assert!((2 * buckets..=6 * buckets).contains(&received.samples.len()));
    assert!(
        received
            .samples
            .windows(2)
            .all(|pair| pair[0][0] < pair[1][0])
    );
    for cycle in received
        .samples
        .chunk_by(|a, b| (5.0 * a[0]) as u32 == (5.0 * b[0]) as u32)
    {
        let most = cycle
            .iter()
            .map(|sample| sample[1])
            .fold(f64::MIN, f64::max);
        let least = cycle
            .iter()
            .map(|sample| sample[1])
            .fold(f64::MAX, f64::min);
        assert!(
            (most - 0.1).abs() < 1e-7 && (least + 0.1).abs() < 1e-7,
            "{most} {least}"
        );
    }
    // Each sample is unchanged: no phase has moved.
    for [time, displacement, force, law] in &received.samples {
        let exact = sine((time * rate).round() as u64, rate);
        assert_eq!(*displacement, f64::from(exact.displacement));
        assert_eq!(*force, f64::from(exact.force));
        assert_eq!(*law, f64::from(exact.law_force));
    }
    assert_eq!(received.cycles.len(), 15);
    assert!(received.cycles.iter().all(|cycle| cycle[6] == 2.0));
    assert_eq!(received.texts[0]["about"]["title"], "a test");
    assert_eq!(received.texts[0]["bucket_samples"], 20);
    let kinds: Vec<&str> = received
        .texts
        .iter()
        .map(|text| text["type"].as_str().unwrap())
        .collect();
    assert!(kinds.contains(&"event"));
    assert_eq!(received.state()["state"], "finished");
}

#[test]
fn who_comes_late_gets_what_is_kept_and_no_more() {
    let limits = Limits {
        samples: 1000,
        ..Limits::default()
    };
    // At this rate everything is kept.
    let rate = 500.0;
    let (mut page, place) = page(rate, limits);
    (0..5000).for_each(|tick| page.sample(&sine(tick, rate)));
    page.state(&State::Stopped {
        time: 10.0,
        cause: "the force exceeded its limit".into(),
    });
    let mut socket = connect(place);
    let reader = std::thread::spawn(move || Received::all(&mut socket));
    assert!(page.wait_for_viewer(PATIENCE));
    page.close(PATIENCE);
    let received = reader.join().unwrap();
    assert_eq!(received.samples.len(), 1000);
    assert_eq!(received.samples[0][0], 8.0);
    assert_eq!(received.missed, 0);
    assert_eq!(received.state()["state"], "stopped");
    assert_eq!(received.state()["cause"], "the force exceeded its limit");
}

/// A page that stops reading for a while: the rig continues, memory stays constant, and the page learns how much it has missed.
#[test]
fn who_is_slow_misses_samples_and_is_told_how_many() {
    let limits = Limits {
        samples: 1 << 16,
        behind: 1 << 14,
        ..Limits::default()
    };
    let rate = 500.0;
    let (mut page, place) = page(rate, limits);
    let mut socket = connect(place);
    assert!(page.wait_for_viewer(PATIENCE));
    // 32 MB: more than the buffers of a connection hold. Nothing is read meanwhile.
    let ticks = 2_000_000;
    (0..ticks).for_each(|tick| page.sample(&sine(tick, rate)));
    page.state(&State::Finished { time: 1.0 });
    let reader = std::thread::spawn(move || Received::all(&mut socket));
    let seen = page.close(PATIENCE);
    let received = reader.join().unwrap();
    assert!(received.missed > 0);
    assert_eq!(received.missed, seen.missed);
    assert_eq!(received.samples.len() as u64 + received.missed, ticks);
    assert_eq!(received.state()["state"], "finished");
}

#[test]
fn a_page_that_leaves_takes_nothing_with_it() {
    let (mut page, place) = page(1000.0, Limits::default());
    drop(connect(place));
    let mut stays = connect(place);
    (0..1000).for_each(|tick| page.sample(&sine(tick, 1000.0)));
    let reader = std::thread::spawn(move || Received::all(&mut stays));
    page.close(PATIENCE);
    assert_eq!(reader.join().unwrap().samples.len(), 1000);
}

#[test]
fn a_port_that_is_taken_and_a_rate_that_is_none_are_refused() {
    let (_page, place) = page(1000.0, Limits::default());
    let about = |sample_rate| About {
        sample_rate,
        ..About::default()
    };
    let taken = LivePage::start(place.port(), about(1.0), Limits::default());
    let said = taken.unwrap_err().to_string();
    assert!(said.contains(&format!("--live {}", place.port())), "{said}");
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(LivePage::start(0, about(rate), Limits::default()).is_err());
    }
}

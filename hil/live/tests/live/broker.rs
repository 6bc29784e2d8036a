//! A real broker, Mosquitto, started and stopped by a test. Shared by the tests that need one.

use std::io::{BufRead as _, BufReader};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use super::common::has;

/// Longer than any step here, so that a hanging test ends.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// Debian's path, which is not in everybody's search path.
const MOSQUITTO: &str = "/usr/sbin/mosquitto";

/// A separate broker at a free port.
pub struct Mosquitto {
    process: Child,
    port: u16,
    configuration: tempfile::TempDir,
}

impl Mosquitto {
    /// `None` if Mosquitto is not installed.
    pub fn start(login: Option<(&str, &str)>) -> Option<Self> {
        if !has(MOSQUITTO, "mosquitto") || !has("mosquitto_sub", "mosquitto-clients") {
            return None;
        }
        let configuration = tempfile::tempdir().unwrap();
        let passwords = configuration.path().join("passwords");
        let mut text = String::new();
        if let Some((user, password)) = login {
            let made = Command::new("mosquitto_passwd")
                .args(["-b", "-c"])
                .arg(&passwords)
                .args([user, password])
                .status();
            assert!(made.unwrap().success());
            text += &format!(
                "password_file {}\nallow_anonymous false\n",
                passwords.display()
            );
        } else {
            text += "allow_anonymous true\n";
        }
        // The user who starts the broker owns its files, including root.
        text += "user root\n";
        // What a stopped broker keeps for a named subscriber.
        let kept = configuration.path().display();
        text += &format!("persistence true\npersistence_location {kept}/\n");
        let port = free_port();
        text += &format!("listener {port} 127.0.0.1\n");
        std::fs::write(configuration.path().join("mosquitto.conf"), text).unwrap();
        let process = serve(configuration.path(), port);
        Some(Self {
            process,
            port,
            configuration,
        })
    }

    pub fn port(&self) -> u16 {
        self.port
    }

    /// Stops, and starts again at the same port, with the subscriptions of named subscribers.
    #[allow(dead_code, reason = "not every test that shares this file restarts it")]
    pub fn restart(&mut self, between: impl FnOnce()) {
        // It writes what it keeps when it is asked to end, not when it is killed.
        let asked = Command::new("kill")
            .arg(self.process.id().to_string())
            .status();
        assert!(asked.unwrap().success());
        self.process.wait().unwrap();
        between();
        self.process = serve(self.configuration.path(), self.port);
    }

    /// Receives everything under `mesh-damper`, retained messages first.
    pub fn subscribe(&self, login: Option<(&str, &str)>) -> Heard {
        match login {
            Some((user, password)) => self.subscribe_with(&["-u", user, "-P", password]),
            None => self.subscribe_with(&[]),
        }
    }

    /// The same as the subscriber `name`: while it is away, the broker keeps its messages, and sends them when it is back.
    #[allow(dead_code, reason = "not every test that shares this file restarts it")]
    pub fn subscribe_as(&self, name: &str) -> Heard {
        self.subscribe_with(&["-c", "-i", name])
    }

    fn subscribe_with(&self, options: &[&str]) -> Heard {
        let mut command = Command::new("mosquitto_sub");
        command
            .args(["-h", "127.0.0.1", "-p", &self.port.to_string(), "-q", "1"])
            .args(["-t", "mesh-damper/#", "-F", "%r %t %p"])
            .args(options);
        let mut process = command.stdout(Stdio::piped()).spawn().unwrap();
        let lines = BufReader::new(process.stdout.take().unwrap());
        Heard { process, lines }
    }
}

impl Drop for Mosquitto {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

pub fn free_port() -> u16 {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    listener.local_addr().unwrap().port()
}

fn serve(configuration: &Path, port: u16) -> Child {
    let process = Command::new(MOSQUITTO)
        .arg("-c")
        .arg(configuration.join("mosquitto.conf"))
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let deadline = Instant::now() + PATIENCE;
    while TcpStream::connect((Ipv4Addr::LOCALHOST, port)).is_err() {
        assert!(Instant::now() < deadline, "the broker does not start");
        std::thread::yield_now();
    }
    process
}

/// The messages of a subscriber.
pub struct Heard {
    process: Child,
    lines: BufReader<ChildStdout>,
}

/// One message.
#[derive(Debug)]
pub struct Message {
    #[allow(dead_code, reason = "not every test that shares this file asks")]
    pub retained: bool,
    pub topic: String,
    pub payload: Value,
}

impl Heard {
    pub fn next(&mut self) -> Message {
        let mut line = String::new();
        assert!(
            self.lines.read_line(&mut line).unwrap() > 0,
            "the broker has gone"
        );
        let mut parts = line.splitn(3, ' ');
        let mut part = || parts.next().unwrap().to_owned();
        Message {
            retained: part() == "1",
            topic: part(),
            payload: serde_json::from_str(&part()).unwrap(),
        }
    }

    /// All messages up to the status `state`, including that one.
    pub fn until(&mut self, state: &str) -> Vec<Message> {
        let mut messages = Vec::new();
        loop {
            let message = self.next();
            let is_last = message.topic.ends_with("/status") && message.payload["state"] == state;
            messages.push(message);
            if is_last {
                return messages;
            }
        }
    }
}

impl Drop for Heard {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

//! The live page: a server on the loopback interface, with a thread for each connection.

mod assets;
mod http;
mod viewer;

use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::SeqCst};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use mesh_damper_recording::error::InputError;
use serde_json::{Value, json};

use crate::decimate::Decimator;
use crate::frame;
use crate::history::{History, Limits, Seen};
use crate::values::{About, CycleResult, Event, Listener, Sample, State};

/// Buckets a second at least: with two samples or more of each, the loop of a cycle of 20 Hz is drawn by 50 points.
const BUCKETS_PER_SECOND: f64 = 500.0;
/// Connections at a time; who comes beyond them is sent away.
const MOST_CONNECTIONS: usize = 32;
/// From a connection that could not be taken to the next try.
const AFTER_AN_ERROR: Duration = Duration::from_millis(50);
/// How long a page may take to say goodbye once it was asked to.
const GOODBYE: Duration = Duration::from_secs(1);

/// A page on the loopback interface that draws a test while it runs.
///
/// Telling it of a sample takes the lock of a ring for as long as a few of them are copied. How many look, and how fast they are, does not
/// matter. It goes away when it is dropped; [`LivePage::close`] waits for the pages to get what is left first.
#[derive(Debug)]
pub struct LivePage {
    shared: Arc<Shared>,
    address: SocketAddr,
    decimator: Decimator,
    acceptor: Option<JoinHandle<()>>,
}

/// What the threads share.
#[derive(Debug)]
struct Shared {
    about: Value,
    history: Mutex<History>,
    connections: AtomicUsize,
    viewers: Mutex<Viewers>,
    /// A viewer has come or gone.
    changed: Condvar,
    /// Nothing more comes: who has everything goes.
    closing: AtomicBool,
    /// Everybody goes.
    ended: AtomicBool,
}

/// Of all viewers.
#[derive(Debug, Default)]
struct Viewers {
    /// That are there.
    now: usize,
    /// That ever came.
    ever: u64,
    /// What those that have gone were given.
    gone: Seen,
}

/// A thread that panicked leaves nothing half done in what is locked here.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl LivePage {
    /// Serves the page for the test that is `about` at `port` of 127.0.0.1; 0 lets the system choose one.
    ///
    /// # Errors
    /// A port that is taken or not allowed, and a sample rate that is not above 0.
    pub fn start(port: u16, about: About, limits: Limits) -> Result<Self, InputError> {
        let refused = |error: std::io::Error| {
            InputError::new(
                format!("--live {port}"),
                format!("the page cannot be served there: {error}"),
                "give another port, or none so that a free one is taken",
            )
        };
        let rate = about.sample_rate;
        if !(rate.is_finite() && rate > 0.0) {
            return Err(InputError::new(
                "the live page",
                format!("a sample rate of {rate} Hz is not above 0"),
                "give the rate at which samples come",
            ));
        }
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let decimator = Decimator::new((rate / BUCKETS_PER_SECOND).round() as usize);
        let shared = Arc::new(Shared {
            about: json!({
                "type": "about",
                "format": "mesh-damper live",
                "version": frame::VERSION,
                "run": run_id(),
                "bucket_samples": decimator.length(),
                "history_samples": limits.samples,
                "about": about,
            }),
            history: Mutex::new(History::new(limits)),
            connections: AtomicUsize::new(0),
            viewers: Mutex::default(),
            changed: Condvar::new(),
            closing: AtomicBool::new(false),
            ended: AtomicBool::new(false),
        });
        let accepting = shared.clone();
        let acceptor = std::thread::spawn(move || accept(&listener, &accepting));
        Ok(Self {
            shared,
            address,
            decimator,
            acceptor: Some(acceptor),
        })
    }

    /// Where it is, for a browser on this machine.
    pub fn address(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Pages that look now.
    pub fn viewers(&self) -> usize {
        lock(&self.shared.viewers).now
    }

    /// Pages that have looked so far.
    pub fn viewers_so_far(&self) -> u64 {
        lock(&self.shared.viewers).ever
    }

    /// Waits until a page looks, for `most` at most, and says whether one does.
    pub fn wait_for_viewer(&self, most: Duration) -> bool {
        self.wait(most, |viewers| viewers.now > 0)
    }

    /// Waits until the pages have everything, for `most` at most, ends the server, and says what the pages were given.
    pub fn close(mut self, most: Duration) -> Seen {
        self.flush();
        self.shared.closing.store(true, SeqCst);
        self.wait(most, |viewers| viewers.now == 0);
        self.end();
        // Those that were too slow for that go by themselves now.
        self.wait(GOODBYE, |viewers| viewers.now == 0);
        lock(&self.shared.viewers).gone
    }

    fn wait(&self, most: Duration, is_so: impl Fn(&Viewers) -> bool) -> bool {
        let viewers = lock(&self.shared.viewers);
        let waited = self
            .shared
            .changed
            .wait_timeout_while(viewers, most, |viewers| !is_so(viewers));
        let (viewers, _) = waited.unwrap_or_else(PoisonError::into_inner);
        is_so(&viewers)
    }

    /// What is left in the bucket.
    fn flush(&mut self) {
        let kept = self.decimator.flush();
        lock(&self.shared.history).samples(kept.samples());
    }

    fn end(&mut self) {
        self.shared.ended.store(true, SeqCst);
        if let Some(acceptor) = self.acceptor.take() {
            // It waits for a connection. Where none can be made it has ended already.
            let _ = TcpStream::connect_timeout(&self.address, Duration::from_secs(1));
            let _ = acceptor.join();
        }
    }
}

impl Drop for LivePage {
    fn drop(&mut self) {
        self.end();
    }
}

impl Listener for LivePage {
    fn sample(&mut self, sample: &Sample) {
        let kept = self.decimator.push(sample);
        if !kept.samples().is_empty() {
            lock(&self.shared.history).samples(kept.samples());
        }
    }

    fn cycle(&mut self, cycle: &CycleResult) {
        lock(&self.shared.history).cycle(*cycle);
    }

    fn event(&mut self, event: &Event) {
        lock(&self.shared.history).event(event.clone());
    }

    fn state(&mut self, state: &State) {
        if state.is_over() {
            self.flush();
        }
        lock(&self.shared.history).state(state.clone());
    }
}

/// Tells one test from the next at the same address.
fn run_id() -> String {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let since = now.unwrap_or_default().as_millis();
    format!("{}-{since}", std::process::id())
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    for stream in listener.incoming() {
        if shared.ended.load(SeqCst) {
            return;
        }
        let Ok(stream) = stream else {
            // Too many files are open, for example: that does not pass sooner by asking at once.
            std::thread::sleep(AFTER_AN_ERROR);
            continue;
        };
        if shared.connections.fetch_add(1, SeqCst) >= MOST_CONNECTIONS {
            shared.connections.fetch_sub(1, SeqCst);
            continue;
        }
        let shared = shared.clone();
        std::thread::spawn(move || {
            // Who has gone is told nothing more.
            let _ = http::serve(stream, &shared);
            shared.connections.fetch_sub(1, SeqCst);
        });
    }
}

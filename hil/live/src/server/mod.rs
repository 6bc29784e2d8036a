//! The live page: a server on the loopback interface, with a thread for each connection.

mod assets;
mod http;
mod viewer;

use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::SeqCst};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use mesh_damper_output::error::InputError;
use serde_json::{Value, json};

use crate::decimate::Decimator;
use crate::frame;
use crate::history::{Delivered, History, Limits};
use crate::values::{About, CycleResult, Event, Listener, Sample, State};

/// Fewest buckets per second: with two samples or more from each, 50 points show the loop of a cycle of 20 Hz.
const BUCKETS_PER_SECOND: f64 = 500.0;
/// Most connections at a time; further clients are refused.
const MOST_CONNECTIONS: usize = 32;
/// Delay after a connection that could not be accepted.
const AFTER_AN_ERROR: Duration = Duration::from_millis(50);
/// Time limit for a page to say goodbye after the server asks it to.
const GOODBYE: Duration = Duration::from_secs(1);

/// A page on the loopback interface that plots a test while it runs.
///
/// A call with a sample holds the lock of a ring while a few samples are copied. The number of viewers and their speed do not
/// matter. Dropping it stops the server; [`LivePage::close`] first waits until the pages have received everything.
#[derive(Debug)]
pub struct LivePage {
    shared: Arc<Shared>,
    address: SocketAddr,
    decimator: Decimator,
    acceptor: Option<JoinHandle<()>>,
}

/// The state shared by the threads.
#[derive(Debug)]
struct Shared {
    about: Value,
    history: Mutex<History>,
    connections: AtomicUsize,
    viewers: Mutex<Viewers>,
    /// A viewer has come or gone.
    changed: Condvar,
    /// Nothing more comes: viewers that have everything leave.
    closing: AtomicBool,
    /// All viewers leave.
    ended: AtomicBool,
}

/// Statistics of all viewers.
#[derive(Debug, Default)]
struct Viewers {
    /// Present viewers.
    now: usize,
    /// All viewers so far.
    ever: u64,
    /// Totals of the viewers that have gone.
    gone: Delivered,
}

/// A thread that panics leaves no half-done change in the locked data.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl LivePage {
    /// Serves the page for the test that `about` describes at `port` of 127.0.0.1; 0 lets the system choose one.
    ///
    /// # Errors
    /// The port is taken or not allowed, or the sample rate is not above 0.
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

    /// Its address, for a browser on this machine.
    pub fn address(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Pages that are open now.
    pub fn viewers(&self) -> usize {
        lock(&self.shared.viewers).now
    }

    /// Pages that were opened so far.
    pub fn viewers_so_far(&self) -> u64 {
        lock(&self.shared.viewers).ever
    }

    /// Waits up to `most` until a page is open, and returns whether one is.
    pub fn wait_for_viewer(&self, most: Duration) -> bool {
        self.wait(most, |viewers| viewers.now > 0)
    }

    /// Waits up to `most` until the pages have everything, ends the server, and returns the totals of the pages.
    pub fn close(mut self, most: Duration) -> Delivered {
        self.flush();
        self.shared.closing.store(true, SeqCst);
        self.wait(most, |viewers| viewers.now == 0);
        self.end();
        // Pages that were too slow leave now.
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

    /// The rest of the bucket.
    fn flush(&mut self) {
        let kept = self.decimator.flush();
        lock(&self.shared.history).samples(kept.samples());
    }

    fn end(&mut self) {
        self.shared.ended.store(true, SeqCst);
        if let Some(acceptor) = self.acceptor.take() {
            // The thread waits for a connection. If none can be made, it has already ended.
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

/// Distinguishes one test from the next at the same address.
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
            // For example, too many files are open: immediate retries would not help.
            std::thread::sleep(AFTER_AN_ERROR);
            continue;
        };
        if shared.connections.fetch_add(1, SeqCst) >= MOST_CONNECTIONS {
            shared.connections.fetch_sub(1, SeqCst);
            continue;
        }
        let shared = shared.clone();
        std::thread::spawn(move || {
            // A viewer that has gone receives nothing more.
            let _ = http::serve(stream, &shared);
            shared.connections.fetch_sub(1, SeqCst);
        });
    }
}

//! One request: a file of the page, or the WebSocket.
//!
//! The server listens on the loopback interface only. Still, a page of another site, open in a browser on this machine, can send
//! requests to it, or have its own name point here (DNS rebinding). So `Host` has to name this machine, and the WebSocket opens
//! only for this page: a browser states in `Origin` whose page asks. A program that is no browser sends no `Origin`, and may read
//! along, as any program started on this machine may.

use std::io::{self, Read as _, Write as _};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

use tungstenite::handshake::derive_accept_key;

use super::assets::ASSETS;
use super::{Shared, viewer};

/// Most bytes of a request; it has no body.
const MOST_OF_A_REQUEST: usize = 8 << 10;
/// Time limit for receiving a request, and for sending an answer.
const PATIENCE: Duration = Duration::from_secs(5);
/// Time for a refused client to notice.
const LINGER: Duration = Duration::from_millis(200);
/// Path of the WebSocket.
const SOCKET: &str = "/live";

/// Answers the request on `stream`.
pub(super) fn serve(mut stream: TcpStream, shared: &Shared) -> io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let Some(request) = read(&mut stream)? else {
        return answer(&mut stream, "400 Bad Request", "This is no request.\n");
    };
    if !request.host.as_deref().is_some_and(is_own_name) {
        let text = "This page is for 127.0.0.1 or localhost alone.\n";
        return answer(&mut stream, "421 Misdirected Request", text);
    }
    if request.method != "GET" {
        return answer(
            &mut stream,
            "405 Method Not Allowed",
            "Only GET is answered.\n",
        );
    }
    if request.path == SOCKET {
        return open_socket(stream, &request, shared);
    }
    match ASSETS.iter().find(|asset| asset.path == request.path) {
        Some(asset) => respond(&mut stream, "200 OK", asset.kind, asset.bytes, &request),
        None => answer(&mut stream, "404 Not Found", "There is no such file.\n"),
    }
}

/// The relevant parts of a request.
#[derive(Debug, Default)]
struct Request {
    method: String,
    path: String,
    host: Option<String>,
    origin: Option<String>,
    upgrade: Option<String>,
    version: Option<String>,
    key: Option<String>,
}

/// The request's head, or `None` if it is invalid.
fn read(stream: &mut TcpStream) -> io::Result<Option<Request>> {
    let deadline = Instant::now() + PATIENCE;
    let mut bytes = Vec::new();
    let mut part = [0; 1024];
    while bytes.len() <= MOST_OF_A_REQUEST {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(None);
        }
        stream.set_read_timeout(Some(left))?;
        let count = stream.read(&mut part)?;
        if count == 0 {
            return Ok(None);
        }
        bytes.extend(&part[..count]);
        let mut headers = [httparse::EMPTY_HEADER; 64];
        let mut parsed = httparse::Request::new(&mut headers);
        match parsed.parse(&bytes) {
            Ok(httparse::Status::Partial) => {}
            Ok(httparse::Status::Complete(_)) => return Ok(Request::of(&parsed)),
            Err(_) => return Ok(None),
        }
    }
    Ok(None)
}

impl Request {
    /// `None` if a decisive header occurs twice.
    fn of(parsed: &httparse::Request<'_, '_>) -> Option<Self> {
        let path = parsed.path.unwrap_or_default();
        let mut request = Self {
            method: parsed.method.unwrap_or_default().to_owned(),
            path: path.split('?').next().unwrap_or_default().to_owned(),
            ..Self::default()
        };
        for header in parsed.headers.iter() {
            let place = match header.name.to_ascii_lowercase().as_str() {
                "host" => &mut request.host,
                "origin" => &mut request.origin,
                "upgrade" => &mut request.upgrade,
                "sec-websocket-version" => &mut request.version,
                "sec-websocket-key" => &mut request.key,
                _ => continue,
            };
            let value = String::from_utf8_lossy(header.value).into_owned();
            if place.replace(value).is_some() {
                return None;
            }
        }
        Some(request)
    }
}

/// Whether `host` names this machine, at any port: a tunnel may have another port at its other end.
fn is_own_name(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    };
    name == "127.0.0.1" || name.eq_ignore_ascii_case("localhost")
}

fn open_socket(mut stream: TcpStream, request: &Request, shared: &Shared) -> io::Result<()> {
    let own = request.host.as_ref().map(|host| format!("http://{host}"));
    if let Some(origin) = &request.origin
        && !own.is_some_and(|own| own.eq_ignore_ascii_case(origin))
    {
        let text = "Another site's page may not read this.\n";
        return answer(&mut stream, "403 Forbidden", text);
    }
    let asks = |value: &Option<String>, wanted: &str| {
        let value = value.as_ref();
        value.is_some_and(|value| value.eq_ignore_ascii_case(wanted))
    };
    let key = match &request.key {
        Some(key) if asks(&request.upgrade, "websocket") && asks(&request.version, "13") => key,
        _ => {
            let text = "A WebSocket of version 13 is here.\n";
            return answer(&mut stream, "426 Upgrade Required", text);
        }
    };
    let answer = format!(
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: {}\r\n\r\n",
        derive_accept_key(key.as_bytes())
    );
    viewer::show(stream, &answer, shared)
}

fn answer(stream: &mut TcpStream, status: &str, text: &str) -> io::Result<()> {
    let kind = "text/plain; charset=utf-8";
    respond(stream, status, kind, text.as_bytes(), &Request::default())?;
    // If the connection were closed with unread data, the answer would be lost.
    stream.shutdown(Shutdown::Write)?;
    stream.set_read_timeout(Some(LINGER))?;
    stream.read(&mut [0; MOST_OF_A_REQUEST]).map(drop)
}

/// The page may load its own files, and connect to its own server; nothing else.
fn respond(
    stream: &mut TcpStream,
    status: &str,
    kind: &str,
    body: &[u8],
    request: &Request,
) -> io::Result<()> {
    let socket = match &request.host {
        Some(host) if is_own_name(host) => format!(" ws://{host}"),
        _ => String::new(),
    };
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\
         Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\nReferrer-Policy: no-referrer\r\n\
         Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
         connect-src 'self'{socket}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\r\n",
        body.len()
    )?;
    stream.write_all(body)?;
    stream.flush()
}

#[cfg(test)]
mod tests {
    use super::is_own_name;

    #[test]
    fn only_this_machine_has_the_pages_name() {
        for own in ["127.0.0.1:8000", "localhost:1", "LOCALHOST", "127.0.0.1"] {
            assert!(is_own_name(own), "{own}");
        }
        for other in [
            "",
            "example.com",
            "127.0.0.1.example.com:8000",
            "localhost.example.com",
            "127.0.0.1:x",
            "0.0.0.0:8000",
            "[::1]:8000",
            "127.0.0.1@example.com",
        ] {
            assert!(!is_own_name(other), "{other}");
        }
    }
}

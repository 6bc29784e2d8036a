//! The address of a broker, from a URL.

use std::fmt::{self, Debug, Formatter};
use std::str::FromStr;
use std::time::Duration;

use percent_encoding::percent_decode_str;
use rumqttc::{LastWill, MqttOptions, QoS};

/// Port of MQTT without TLS.
const PORT: u16 = 1883;
/// Interval of keep-alive messages on an idle connection. A lost broker is noticed within twice this time.
const KEEP_ALIVE: Duration = Duration::from_secs(5);

/// A broker, and the name of the rig in the topics: `mqtt://[USER[:PASSWORD]@]HOST[:PORT][/RIG]`.
///
/// ```
/// use mesh_damper_live::Broker;
///
/// let broker: Broker = "mqtt://lab:p%40ss@broker.local/rig-2".parse().unwrap();
/// assert_eq!(broker.to_string(), "mqtt://broker.local:1883/rig-2");
/// assert!("mqtt://broker.local/rig/2".parse::<Broker>().is_err());
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct Broker {
    host: String,
    port: u16,
    rig: String,
    user: Option<String>,
    password: Option<String>,
}

impl FromStr for Broker {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let rest = match text.split_once("://") {
            Some(("mqtt", rest)) => rest,
            Some(("mqtts", _)) => {
                return Err(
                    "TLS is not supported: give mqtt:// and a broker on this machine or network; that broker can forward over TLS"
                        .into(),
                );
            }
            _ => return Err("give mqtt://HOST, such as mqtt://localhost/rig-1".into()),
        };
        let (authority, rig) = rest.split_once('/').unwrap_or((rest, ""));
        let (login, place) = match authority.rsplit_once('@') {
            Some((login, place)) => (Some(login), place),
            None => (None, authority),
        };
        let (host, port) = host_and_port(place)?;
        let (user, password) = match login.map(|login| login.split_once(':').unwrap_or((login, "")))
        {
            Some(("", _)) => return Err("a user's name is missing before @".into()),
            Some((user, "")) => (Some(decoded(user)?), None),
            Some((user, password)) => (Some(decoded(user)?), Some(decoded(password)?)),
            None => (None, None),
        };
        let rig = match rig {
            "" => "rig".into(),
            rig => decoded(rig)?,
        };
        // These would address other topics, or several.
        if let Some(bad) = rig
            .chars()
            .find(|letter| matches!(letter, '/' | '+' | '#' | '$') || letter.is_control())
        {
            return Err(format!("the rig's name contains {bad:?}: leave it out"));
        }
        if rig.len() > 64 {
            return Err(format!(
                "the rig's name has {} bytes: give at most 64",
                rig.len()
            ));
        }
        Ok(Self {
            host,
            port,
            rig,
            user,
            password,
        })
    }
}

fn host_and_port(place: &str) -> Result<(String, u16), String> {
    let (host, port) = match place.strip_prefix('[') {
        Some(rest) => {
            let (host, rest) = rest
                .split_once(']')
                .ok_or("a ] is missing after the host")?;
            (host, rest.strip_prefix(':'))
        }
        None => match place.split_once(':') {
            Some((host, port)) => (host, Some(port)),
            None => (place, None),
        },
    };
    let is_good = |byte: u8| byte.is_ascii_alphanumeric() || b".-_:%".contains(&byte);
    if host.is_empty() || !host.bytes().all(is_good) {
        return Err(format!("{host:?} is no host: give mqtt://HOST"));
    }
    let port = match port {
        None => PORT,
        Some(port) => match port.parse() {
            Ok(port) if port > 0 => port,
            _ => return Err(format!("{port:?} is no port: give 1 to 65535")),
        },
    };
    Ok((host.to_owned(), port))
}

fn decoded(text: &str) -> Result<String, String> {
    let decoded = percent_decode_str(text).decode_utf8();
    decoded
        .map(|text| text.into_owned())
        .map_err(|_| "the percent-encoded part is not UTF-8".into())
}

impl Broker {
    /// The rig's name in the topics.
    pub fn rig(&self) -> &str {
        &self.rig
    }

    /// The same with `password`, if its URL has a user without one.
    #[must_use]
    pub fn with_password(mut self, password: Option<String>) -> Self {
        if self.user.is_some() && self.password.is_none() {
            self.password = password;
        }
        self
    }

    /// A connection with `will` as its last will at `topic`.
    pub(super) fn options(&self, topic: &str, will: &str) -> MqttOptions {
        let id = format!("mesh-damper-{}-{}", self.rig, std::process::id());
        let mut options = MqttOptions::new(id, self.host.clone(), self.port);
        options
            .set_keep_alive(KEEP_ALIVE)
            .set_clean_session(true)
            .set_last_will(LastWill::new(
                topic,
                will.to_owned(),
                QoS::AtLeastOnce,
                true,
            ));
        if let Some(user) = &self.user {
            options.set_credentials(user, self.password.clone().unwrap_or_default());
        }
        options
    }
}

/// Without user and password, because it is printed.
impl fmt::Display for Broker {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (host, port, rig) = (&self.host, self.port, &self.rig);
        match host.contains(':') {
            true => write!(f, "mqtt://[{host}]:{port}/{rig}"),
            false => write!(f, "mqtt://{host}:{port}/{rig}"),
        }
    }
}

/// As [`fmt::Display`], so that no log contains the password.
impl Debug for Broker {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_url_is_taken_apart() {
        let broker: Broker = "mqtt://lab:p%40s%2Fs@10.0.0.7:2883/rig%201"
            .parse()
            .unwrap();
        assert_eq!((broker.host.as_str(), broker.port), ("10.0.0.7", 2883));
        assert_eq!(broker.user.as_deref(), Some("lab"));
        assert_eq!(broker.password.as_deref(), Some("p@s/s"));
        assert_eq!(broker.rig(), "rig 1");
        let options = broker.options("t", "w");
        assert_eq!(options.credentials().unwrap().password, "p@s/s");
        // A password from elsewhere is for a user without one.
        let password = |url: &str| {
            let broker: Broker = url.parse().unwrap();
            broker.with_password(Some("other".into())).password
        };
        assert_eq!(password("mqtt://lab@host").as_deref(), Some("other"));
        assert_eq!(password("mqtt://lab:own@host").as_deref(), Some("own"));
        assert_eq!(password("mqtt://host"), None);
        let plain: Broker = "mqtt://[::1]".parse().unwrap();
        assert_eq!(plain.to_string(), "mqtt://[::1]:1883/rig");
        assert_eq!(plain.user, None);
    }

    #[test]
    fn the_password_is_not_printed() {
        let broker: Broker = "mqtt://lab:geheim@localhost".parse().unwrap();
        assert!(!format!("{broker} {broker:?}").contains("geheim"));
        // Nor do refused URLs.
        for bad in ["mqtt://lab:geheim@localhost:0", "mqtt://lab:geheim@"] {
            let said = bad.parse::<Broker>().unwrap_err();
            assert!(!said.contains("geheim"), "{said}");
        }
    }

    #[test]
    fn what_is_no_url_is_refused() {
        for bad in [
            "",
            "localhost",
            "http://localhost",
            "mqtts://localhost",
            "mqtt://",
            "mqtt://:1883",
            "mqtt://host:port",
            "mqtt://host:70000",
            "mqtt://host:0",
            "mqtt://@host",
            "mqtt://[::1",
            "mqtt://ho st",
            "mqtt://host/a/b",
            "mqtt://host/+",
            "mqtt://host/%23",
            "mqtt://u:%ff@host",
        ] {
            assert!(bad.parse::<Broker>().is_err(), "{bad}");
        }
    }
}

//! `hil upload`: sends a coefficient pack to a running rig.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use mesh_damper::rig::State;
use mesh_damper_link::lockstep::Image;
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use schemars::JsonSchema;
use serde::Serialize;

use super::board::Port;
use super::pack::read_with_info;
use crate::commands::document::AddDocument as _;
use crate::commands::{Failure, say};

/// Send a coefficient pack to a running rig, and wait until the rig uses its law
///
/// Between its ticks, the board checks the pack: the checksum, the tick rate, and that the law is passive. If the board refuses the pack,
/// it keeps its law. If it accepts the pack, it changes to the new law at the end of the cycle.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  hil upload --to serial:/dev/ttyACM0 mount.mdcp")]
pub struct UploadCommand {
    /// The board's serial port, such as serial:/dev/ttyACM0; its firmware runs on its own timer
    #[arg(long, value_name = "serial:PORT")]
    to: Port,
    /// The pack, a file of `hil export --format pack`
    pack: PathBuf,
    /// Wait at most this long for the end of the cycle, in s, 0 to 1000000
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    wait: f64,
    /// Write the result as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// A coefficient pack that was sent to a running rig.
#[derive(JsonSchema, Serialize)]
pub(in crate::commands) struct Uploaded {
    /// The board, as `serial:PORT`.
    to: Port,
    /// Name of the pack; null if the pack has none.
    name: Option<String>,
    /// Identity of the model, 16 hexadecimal digits; null if the pack does not give it.
    identity: Option<String>,
    /// Revision of the pack; null if the pack does not give it.
    revision: Option<u32>,
    /// Size of the pack, bytes.
    bytes: usize,
    /// Tick rate of the rig, Hz.
    tick_rate: f32,
    /// Whether the law is in use. False if the rig does not run: it then uses the law from its start on.
    in_force: bool,
    /// Time from the pack's last byte to the swap, or to the answer of a rig that does not run, s.
    seconds: f64,
    /// Number of ticks that were late in this time.
    late_ticks: u32,
}

impl UploadCommand {
    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new()
            .reads([self.pack.as_path()])
            .writes(&self.json)
            .begin()?;
        let name = self.pack.display().to_string();
        let (bytes, info) = read_with_info(&self.pack)?;
        if !(0.0..=1e6).contains(&self.wait) {
            let problem = format!("{} s is outside its range", self.wait);
            return Err(InputError::new("--wait", problem, "give 0 to 1e6").into());
        }
        let wait = Duration::from_secs_f64(self.wait);
        let (mut board, before) = Image::join(self.to.path())?;
        if before.tick_rate == 0.0 {
            return Err(InputError::new(
                self.to.to_string(),
                "there is no rig on the board yet",
                "set it up with `hil record --from`, which also takes the pack: --pack",
            )
            .into());
        }
        board.send_parts(&bytes).map_err(InputError::from)?;
        let sent = Instant::now();
        while !board.check_pack().map_err(InputError::from)? {}
        let after = loop {
            let about = board.about().map_err(InputError::from)?;
            if about.tick_rate == 0.0 {
                return Err(InputError::new(
                    self.to.to_string(),
                    "the board restarted during the command",
                    "check its supply and its watchdog, then set it up again",
                )
                .into());
            }
            if !about.law_waits || about.state != State::Running {
                break about;
            }
            if sent.elapsed() > wait {
                return Err(InputError::new(
                    self.to.to_string(),
                    format!("the current cycle has not ended within {} s", self.wait),
                    "give a longer --wait; the board still changes to the law at the end of the cycle",
                )
                .into());
            }
        };
        let is_it = info.as_ref().is_none_or(|info| {
            (info.stamp.identity, info.stamp.revision) == (after.identity, after.revision)
        });
        if !is_it {
            return Err(InputError::new(
                self.to.to_string(),
                format!("the board has the law {} instead", after.identity),
                "check for another program that uploads to it, then upload this again",
            )
            .into());
        }
        let uploaded = Uploaded {
            name: info.as_ref().map(|info| info.name.to_string()),
            identity: info.as_ref().map(|info| info.stamp.identity.to_string()),
            revision: info.as_ref().map(|info| info.stamp.revision),
            bytes: bytes.len(),
            tick_rate: after.tick_rate,
            in_force: !after.law_waits,
            seconds: sent.elapsed().as_secs_f64(),
            late_ticks: after.late_ticks.wrapping_sub(before.late_ticks),
            to: self.to,
        };
        outputs.add_document_if(&self.json, &uploaded)?;
        outputs.write()?;
        if self.json.as_deref() != Some(std::path::Path::new("-")) {
            say(&uploaded.in_words(&name));
        }
        Ok(())
    }
}

impl Uploaded {
    fn in_words(&self, file: &str) -> String {
        let late = match self.late_ticks {
            0 => "no tick was late".to_owned(),
            late => format!("{late} ticks were late"),
        };
        if self.in_force {
            format!(
                "The rig began to use the law of {file} {:.3} s after the upload ended; {late}",
                self.seconds
            )
        } else {
            format!("The rig is not running; it will use the law of {file} when it starts; {late}")
        }
    }
}

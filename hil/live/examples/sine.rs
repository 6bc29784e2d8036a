//! A sine at 10 kHz on the live page, for the given number of seconds: `cargo run -p mesh-damper-live --example sine -- 60 8000`.

use std::time::{Duration, Instant};

use mesh_damper_live::{About, CycleResult, Event, Limits, Listener, LivePage, Sample, State};

const RATE: f64 = 10_000.0;
const AMPLITUDE: f64 = 0.1;
const FREQUENCY: f64 = 5.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let seconds: f64 = arguments.next().as_deref().unwrap_or("60").parse()?;
    let port = arguments.next().as_deref().unwrap_or("0").parse()?;
    let about = About {
        title: "A sine".into(),
        specimen: "a spring with a dashpot".into(),
        law: "the same, 10 % stiffer".into(),
        sample_rate: RATE,
        duration: Some(seconds),
        has_cycles: true,
    };
    let mut page = LivePage::start(port, about, Limits::default())?;
    println!("{}", page.address());
    page.state(&State::Running);
    let began = Instant::now();
    for tick in 0..(seconds * RATE) as u64 {
        let time = tick as f64 / RATE;
        let angle = std::f64::consts::TAU * FREQUENCY * time;
        let (displacement, quarter) = (AMPLITUDE * angle.sin(), AMPLITUDE * angle.cos());
        page.sample(&Sample {
            time,
            displacement: displacement as f32,
            force: (displacement + 0.5 * quarter) as f32,
            law_force: (1.1 * displacement + 0.5 * quarter) as f32,
        });
        let per_cycle = (RATE / FREQUENCY) as u64;
        if tick % per_cycle == per_cycle - 1 {
            page.cycle(&CycleResult {
                time,
                cycle: (tick / per_cycle) as u32,
                amplitude: AMPLITUDE as f32,
                frequency: FREQUENCY as f32,
                stiffness: 1.0,
                loss_factor: 0.5,
                law_stiffness: 1.1,
                law_loss_factor: 0.4545,
                error: 0.08,
                temperature: 23.0,
                ..CycleResult::default()
            });
        }
        if tick == (RATE * 2.0) as u64 {
            page.event(&Event {
                time,
                cause: "Nothing".into(),
                text: "two seconds have passed".into(),
                ..Event::default()
            });
        }
        if tick % 50 == 0 {
            let due = began + Duration::from_secs_f64(time);
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
        }
    }
    page.state(&State::Finished { time: seconds });
    page.close(Duration::from_secs(3));
    Ok(())
}

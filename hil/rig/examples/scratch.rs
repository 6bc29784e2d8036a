// Adversarial scenarios on the simulated rig. Not part of the project.
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::law::Law;
use mesh_damper::rig::{Controller, State, Telemetry};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables;
use mesh_damper_rig::actuator::{SensorFault, ServoFault};
use mesh_damper_rig::specimen::DamperForce;
use mesh_damper_rig::{Bench, RigSetup};
use std::cell::Cell;
use std::rc::Rc;

#[derive(Clone, Copy)]
pub struct Cond {
    k: f64,
    c: f64,
    gap: f64,
    pre: f64,
    temp: f64,
    seized: bool,
    neg: f64,
}
#[derive(Clone)]
pub struct Spec {
    co: Coefficients,
    cond: Rc<Cell<Cond>>,
}
impl DamperForce for Spec {
    fn force(&mut self, _: f64, y: f64, v: f64, _: f64, _: f64) -> f64 {
        let n = self.cond.get();
        let felt = y - y.clamp(-n.gap, n.gap);
        let mv = if n.gap > 0.02 * 0.1 && felt == 0.0 {
            0.0
        } else {
            v
        };
        let e = self.co.force(felt, 0.0);
        let f = self.co.force(felt, mv) - e;
        let extra = if n.seized { 20.0 * y } else { 0.0 };
        n.k * e + n.c * f + n.pre + extra + n.neg * v
    }
    fn temperature(&self) -> f64 {
        self.cond.get().temp
    }
}
const NEW: Cond = Cond {
    k: 1.0,
    c: 1.0,
    gap: 0.0,
    pre: 0.0,
    temp: 20.0,
    seized: false,
    neg: 0.0,
};

struct Ctx<'a> {
    tick: u64,
    cyc: f64,
    y: &'a mut f64,
    f: &'a mut f64,
    temp: &'a mut f32,
    cond: &'a mut Cond,
    yfs: f64,
    ffs: f64,
    amp: f64,
    peak: f64,
    phase: f64,
    rng: &'a mut u64,
}
fn rnd(s: &mut u64) -> f64 {
    *s ^= *s << 13;
    *s ^= *s >> 7;
    *s ^= *s << 17;
    (*s >> 11) as f64 / (1u64 << 53) as f64
}

struct Opt {
    amp: f64,
    freq: f64,
    cycles: u32,
    blocks: u32,
    follow: f64,
    force_range: Option<f64>,
    servo_limit: Option<f64>,
    flimit: Option<f64>,
    law_scale: f64,
    seed: u64,
    skip: bool,
}
impl Default for Opt {
    fn default() -> Self {
        Opt {
            amp: 0.1,
            freq: 2.0,
            cycles: 60,
            blocks: 1,
            follow: 0.0,
            force_range: None,
            servo_limit: None,
            flimit: None,
            law_scale: 1.0,
            seed: 5,
            skip: false,
        }
    }
}

fn run(
    name: &str,
    o: &Opt,
    mut hook: impl FnMut(&mut Ctx),
    mut dac_hook: impl FnMut(u64, f64, &mut f64),
    mut plant: impl FnMut(u64, f64, &mut Bench<Spec, 16, 1>),
) {
    let co = tables::interpolate(3.0, o.amp);
    let cond = Rc::new(Cell::new(NEW));
    let spec = Spec {
        co,
        cond: cond.clone(),
    };
    let law = Law::new(
        (co.k1 * o.law_scale) as f32,
        (co.k3 * o.law_scale) as f32,
        (co.c * o.law_scale) as f32,
        co.alpha as f32,
    )
    .unwrap();
    let mut programme = Programme::<16>::new(10_000.0, 1).unwrap();
    for _ in 0..o.blocks {
        programme = programme
            .with(Block::sine(o.amp, o.freq, o.cycles).unwrap())
            .unwrap();
    }
    let mut setup: RigSetup<Spec, 16, 1> =
        RigSetup::new(spec, AugmentedLaw::new(law), programme, o.seed);
    if let Some(r) = o.force_range {
        setup.force_sensor.full_scale = r;
        setup.settings.force_limit = 0.95 * r;
    }
    if let Some(l) = o.servo_limit {
        setup.servo.force_limit = l;
    }
    if let Some(l) = o.flimit {
        setup.settings.force_limit = l;
    }
    setup.settings.health.follow = o.follow;
    let yfs = setup.displacement_sensor.full_scale;
    let ffs = setup.force_sensor.full_scale;
    let limits = (
        setup.settings.displacement_limit,
        setup.settings.force_limit,
    );
    let peak = (0..400)
        .map(|i| {
            let (s, c) = (std::f64::consts::TAU * i as f64 / 400.0).sin_cos();
            co.force(o.amp * s, o.amp * std::f64::consts::TAU * o.freq * c)
                .abs()
        })
        .fold(0.0, f64::max);
    let mut b = Bench::new(setup).unwrap();
    b.rig.start().unwrap();
    let mut events: Vec<String> = vec![];
    let mut stop = None;
    let mut rng = 88172645463325252u64 ^ o.seed;
    let (mut maxd, mut maxf) = (0f64, 0f64);
    let mut beyond = 0u32;
    let mut maxbeyond = 0u32;
    let mut reps: Vec<(u32, f32, f32, f32)> = vec![];
    let mut truth_amp = vec![];
    let mut cur = 0f64;
    let mut lastcyc = 0u32;
    let mut ended_at = 0.0;
    for tick in 0u64.. {
        let cyc = tick as f64 * o.freq / 10_000.0 - 1.0;
        plant(tick, cyc, &mut b);
        let (mut y, mut f) = b.plant.sense();
        let mut c = cond.get();
        let mut temp = c.temp as f32;
        hook(&mut Ctx {
            tick,
            cyc,
            y: &mut y,
            f: &mut f,
            temp: &mut temp,
            cond: &mut c,
            yfs,
            ffs,
            amp: o.amp,
            peak,
            phase: cyc.rem_euclid(1.0),
            rng: &mut rng,
        });
        cond.set(c);
        b.adc.volts[0].set(y);
        b.adc.volts[1].set(f);
        b.rig.set_temperature(temp);
        let t: Telemetry = b.rig.tick();
        let mut v = b.dac.volts.get();
        dac_hook(tick, cyc, &mut v);
        let en = b.enabled.get();
        b.plant.advance(v, en);
        if let Some(e) = t.event {
            events.push(format!(
                "{:?}/{:?}@{:.1}({:?} {:.3})",
                e.cause, e.or, cyc, e.statistic, e.value
            ));
        }
        let (d, fo) = (
            b.plant.servo.displacement().abs(),
            b.plant.servo.force().abs(),
        );
        maxd = maxd.max(d);
        maxf = maxf.max(fo);
        cur = cur.max(d);
        if (d > 1.01 * limits.0 || fo > 1.01 * limits.1) && en {
            beyond += 1;
            maxbeyond = maxbeyond.max(beyond)
        } else {
            beyond = 0
        }
        if let Some(r) = t.report {
            if !r.ramp {
                reps.push((
                    r.cycle,
                    r.measured.stiffness,
                    r.measured.loss_factor,
                    r.nrmse,
                ));
            }
        }
        if t.cycle != lastcyc {
            lastcyc = t.cycle;
            truth_amp.push(cur);
            cur = 0.0;
        }
        if t.state != State::Running {
            if let State::Faulted(ff) = t.state {
                stop = Some(format!("{ff:?}@{cyc:.2}"));
            }
            ended_at = cyc;
            break;
        }
    }
    let first = reps.iter().nth(3).copied().unwrap_or_default();
    let last = reps.iter().rev().nth(1).copied().unwrap_or_default();
    let (ta, tb) = (
        truth_amp.iter().nth(6).copied().unwrap_or(0.0),
        truth_amp.iter().rev().nth(1).copied().unwrap_or(0.0),
    );
    println!(
        "{name}\n    events: {}\n    stop: {}  end@{ended_at:.1}  max true y {:.3}/{:.2} f {:.2}/{:.2} beyond {} ticks; K {:.3}->{:.3} eta {:.3}->{:.3} nrmse {:.3}->{:.3}; true amp {:.4}->{:.4}",
        if events.is_empty() {
            "NONE".into()
        } else {
            events.join(", ")
        },
        stop.unwrap_or("-".into()),
        maxd,
        limits.0,
        maxf,
        limits.1,
        maxbeyond,
        first.1,
        last.1,
        first.2,
        last.2,
        first.3,
        last.3,
        ta,
        tb
    );
}
fn nd(_: u64, _: f64, _: &mut f64) {}
fn np(_: u64, _: f64, _: &mut Bench<Spec, 16, 1>) {}

fn main() {
    let only = std::env::args().nth(1);
    let want = |s: &str| only.as_deref().is_none_or(|o| s.contains(o));
    macro_rules! t {
        ($n:expr, $o:expr, $h:expr) => {
            if want($n) {
                run($n, &$o, $h, nd, np)
            }
        };
        ($n:expr, $o:expr, $h:expr, $d:expr, $p:expr) => {
            if want($n) {
                run($n, &$o, $h, $d, $p)
            }
        };
    }
    let seed = std::env::var("SEED")
        .ok()
        .and_then(|s| s.parse().ok())
        .unwrap_or(5);
    let d = || Opt {
        seed,
        ..Opt::default()
    };
    let on = |c: &Ctx| c.cyc > 30.0;
    t!("00 healthy", d(), |_| {});
    // gain faults
    t!(
        "01 force gain drift -0.05%/cycle over 400",
        Opt { cycles: 440, ..d() },
        |c: &mut Ctx| if on(c) {
            *c.f *= 1.0 - 0.0005 * (c.cyc - 30.0)
        }
    );
    t!("02 force gain step -10%", d(), |c: &mut Ctx| if on(c) {
        *c.f *= 0.9
    });
    t!("03 force gain step +10%", d(), |c: &mut Ctx| if on(c) {
        *c.f *= 1.1
    });
    t!(
        "04 displacement gain step -10% (rig overdrives specimen)",
        d(),
        |c: &mut Ctx| if on(c) {
            *c.y *= 0.9
        }
    );
    t!(
        "05 displacement gain drift -0.1%/cycle to -40%",
        Opt { cycles: 430, ..d() },
        |c: &mut Ctx| if on(c) {
            *c.y *= 1.0 - 0.001 * (c.cyc - 30.0)
        }
    );
    t!(
        "06 displacement gain drift within run-in -40% in 170 cycles",
        Opt { cycles: 240, ..d() },
        |c: &mut Ctx| if c.cyc > 20.0 {
            *c.y *= 1.0 - 0.4 * ((c.cyc - 20.0) / 170.0).min(1.0)
        }
    );
    // connectors and EMI
    t!(
        "07 force connector: 2-sample drop-outs to 0V at random, 1/500",
        d(),
        |c: &mut Ctx| if on(c) {
            thread_drop(c, false)
        }
    );
    t!(
        "08 displacement connector: 2-sample drop-outs to 0V, 1/500",
        d(),
        |c: &mut Ctx| if on(c) {
            thread_drop(c, true)
        }
    );
    t!(
        "09 force open with pickup noise (0V + 0.5% FS noise)",
        d(),
        |c: &mut Ctx| if on(c) {
            *c.f = 0.05 * (rnd(c.rng) - 0.5)
        }
    );
    t!(
        "10 displacement open with pickup noise",
        d(),
        |c: &mut Ctx| if on(c) {
            *c.y = 0.05 * (rnd(c.rng) - 0.5)
        }
    );
    t!(
        "11 force: noise only from the start (never connected)",
        d(),
        |c: &mut Ctx| *c.f = 0.05 * (rnd(c.rng) - 0.5)
    );
    t!(
        "12 EMI bursts 2 ms, 10% of amplitude, both, twice a second",
        d(),
        |c: &mut Ctx| if on(c) && c.tick % 5000 < 20 {
            let (a, b) = (rnd(c.rng) - 0.5, rnd(c.rng) - 0.5);
            *c.f += 0.2 * a * c.peak / c.ffs * 10.24;
            *c.y += 0.2 * b * c.amp / c.yfs * 10.24
        }
    );
    for (n, a) in [
        ("13a 50 Hz hum 2% on force", 0.02),
        ("13b 50 Hz hum 5% on force", 0.05),
        ("13c 50 Hz hum 20% on force", 0.2),
    ] {
        t!(n, d(), |c: &mut Ctx| if on(c) {
            *c.f += a * c.peak / c.ffs * 10.24 * (c.tick as f64 * 0.0314159265).sin()
        });
    }
    for (n, a) in [
        ("14a 50 Hz hum 2% on displacement", 0.02),
        ("14b 50 Hz hum 10% on displacement", 0.1),
    ] {
        t!(n, d(), |c: &mut Ctx| if on(c) {
            *c.y += a * c.amp / c.yfs * 10.24 * (c.tick as f64 * 0.0314159265).sin()
        });
    }
    t!("15 cables swapped from start", d(), |c: &mut Ctx| {
        std::mem::swap(c.y, c.f)
    });
    t!("16 cables swapped at 30", d(), |c: &mut Ctx| if on(c) {
        std::mem::swap(c.y, c.f)
    });
    t!("17 force sign reversed from start", d(), |c: &mut Ctx| *c
        .f =
        -*c.f);
    t!(
        "18 force sign reversed at 30",
        d(),
        |c: &mut Ctx| if on(c) {
            *c.f = -*c.f
        }
    );
    t!(
        "19 displacement sign reversed from start",
        d(),
        |c: &mut Ctx| *c.y = -*c.y
    );
    t!(
        "20 displacement sign reversed from start, amp 0.05",
        Opt { amp: 0.05, ..d() },
        |c: &mut Ctx| *c.y = -*c.y
    );
    t!("21 force frozen with +-1 LSB dither", d(), {
        let mut h = None;
        move |c: &mut Ctx| {
            if on(c) {
                let v = *h.get_or_insert(*c.f);
                *c.f = v + (rnd(c.rng) - 0.5) * 3.0 * 20.48 / 65536.0
            }
        }
    });
    t!("22 displacement frozen with noise (core detached)", d(), {
        let mut h = None;
        move |c: &mut Ctx| {
            if on(c) {
                let v = *h.get_or_insert(*c.y);
                *c.y = v + (rnd(c.rng) - 0.5) * 3.0 * 20.48 / 65536.0
            }
        }
    });
    t!(
        "22b displacement frozen with noise, 0.1 Hz",
        Opt {
            freq: 0.1,
            cycles: 40,
            ..d()
        },
        {
            let mut h = None;
            move |c: &mut Ctx| {
                if on(c) {
                    let v = *h.get_or_insert(*c.y);
                    *c.y = v + (rnd(c.rng) - 0.5) * 3.0 * 20.48 / 65536.0
                }
            }
        }
    );
    t!(
        "23 ADC data bit 11 stuck at 0, force",
        d(),
        |c: &mut Ctx| if on(c) {
            *c.f = stuck_bit(*c.f, 11)
        }
    );
    t!(
        "24 ADC data bit 11 stuck at 0, displacement",
        d(),
        |c: &mut Ctx| if on(c) {
            *c.y = stuck_bit(*c.y, 11)
        }
    );
    // specimen
    t!(
        "25 breaks one by one: 1% each 10 cycles after run-in, 30%",
        Opt { cycles: 540, ..d() },
        |c: &mut Ctx| if c.cyc > 220.0 {
            let p = 1.0 - 0.01 * ((c.cyc - 220.0) / 10.0).floor().min(30.0);
            c.cond.k = p;
            c.cond.c = p
        }
    );
    t!(
        "26 breaks one by one within the run-in: 40% by cycle 190",
        Opt { cycles: 300, ..d() },
        |c: &mut Ctx| {
            let p = 1.0 - 0.4 * ((c.cyc - 20.0) / 170.0).clamp(0.0, 1.0);
            c.cond.k = p;
            c.cond.c = p
        }
    );
    t!(
        "27 same as 26 with follow 0.1",
        Opt {
            cycles: 300,
            follow: 0.1,
            ..d()
        },
        |c: &mut Ctx| {
            let p = 1.0 - 0.4 * ((c.cyc - 20.0) / 170.0).clamp(0.0, 1.0);
            c.cond.k = p;
            c.cond.c = p
        }
    );
    t!(
        "28 break of 20% during learning (cycle 10)",
        d(),
        |c: &mut Ctx| if c.cyc > 10.0 {
            c.cond.k = 0.8;
            c.cond.c = 0.8
        }
    );
    t!(
        "29 break of 30% in a test of 12 blocks x 12 cycles",
        Opt {
            cycles: 12,
            blocks: 12,
            ..d()
        },
        |c: &mut Ctx| if c.cyc > 60.0 {
            c.cond.k = 0.7;
            c.cond.c = 0.7
        }
    );
    t!(
        "30 backlash grows 0.1% of amplitude a cycle after run-in",
        Opt { cycles: 540, ..d() },
        |c: &mut Ctx| c.cond.gap = c.amp * 0.001 * (c.cyc - 220.0).max(0.0)
    );
    t!(
        "31 backlash grows within run-in to 20%",
        Opt { cycles: 300, ..d() },
        |c: &mut Ctx| c.cond.gap = c.amp * 0.2 * ((c.cyc - 20.0) / 170.0).clamp(0.0, 1.0)
    );
    t!(
        "32 seized specimen (+20 kN/mm) at 30",
        d(),
        |c: &mut Ctx| if on(c) {
            c.cond.seized = true
        }
    );
    t!("33 specimen removed at 30", d(), |c: &mut Ctx| if on(c) {
        c.cond.k = 0.0;
        c.cond.c = 0.0
    });
    t!("34 specimen absent from the start", d(), |c: &mut Ctx| {
        c.cond.k = 0.0;
        c.cond.c = 0.0
    });
    t!(
        "35 law wrong by x2 from the start",
        Opt {
            law_scale: 2.0,
            ..d()
        },
        |_| {}
    );
    t!(
        "36 friction rises 20% (seizing, galling) at 30",
        d(),
        |c: &mut Ctx| if on(c) {
            c.cond.c = 1.2
        }
    );
    t!(
        "37 negative damping specimen/flutter at 30",
        d(),
        |c: &mut Ctx| if on(c) {
            c.cond.neg = -0.2
        }
    );
    // temperature channel
    t!(
        "40 NaN temperature for one tick at cycle end, 20% break later",
        d(),
        |c: &mut Ctx| {
            if c.cyc > 25.5 && c.cyc < 26.5 {
                *c.temp = f32::NAN
            }
            if on(c) {
                c.cond.k = 0.8;
                c.cond.c = 0.8
            }
        }
    );
    t!("40b same without the NaN", d(), |c: &mut Ctx| {
        if on(c) {
            c.cond.k = 0.8;
            c.cond.c = 0.8
        }
    });
    t!(
        "41 NaN temperature for good, 40% break",
        Opt { cycles: 120, ..d() },
        |c: &mut Ctx| {
            if c.cyc > 25.0 {
                *c.temp = f32::NAN
            }
            if on(c) {
                c.cond.k = 0.6;
                c.cond.c = 0.6
            }
        }
    );
    t!(
        "42 thermocouple opens (1372 C) at 30 with a 20% break",
        Opt { cycles: 120, ..d() },
        |c: &mut Ctx| if on(c) {
            *c.temp = 1372.0;
            c.cond.k = 0.8;
            c.cond.c = 0.8
        }
    );
    t!(
        "43 thermocouple opens at 30, 20% break at 50 ",
        Opt { cycles: 300, ..d() },
        |c: &mut Ctx| {
            if on(c) {
                *c.temp = 1372.0
            }
            if c.cyc > 50.0 {
                c.cond.k = 0.8;
                c.cond.c = 0.8
            }
        }
    );
    t!(
        "44 thermocouple opens after run-in, then slow loss of 30%",
        Opt { cycles: 600, ..d() },
        |c: &mut Ctx| {
            if c.cyc > 230.0 {
                *c.temp = 1372.0
            }
            let p = 1.0 - 0.3 * ((c.cyc - 240.0) / 300.0).clamp(0.0, 1.0);
            c.cond.k = p;
            c.cond.c = p
        }
    );
    t!(
        "45 thermocouple noise +-15C, 10% break",
        d(),
        |c: &mut Ctx| {
            *c.temp = 20.0 + 30.0 * (rnd(c.rng) as f32 - 0.5);
            if on(c) {
                c.cond.k = 0.9;
                c.cond.c = 0.9
            }
        }
    );
    t!(
        "46 force zero drifts with temperature: +20C over 200 cycles, 0.5%/C",
        Opt { cycles: 320, ..d() },
        |c: &mut Ctx| {
            let dt = 20.0 * ((c.cyc - 60.0) / 200.0).clamp(0.0, 1.0);
            *c.temp = 20.0 + dt as f32;
            *c.f += 0.005 * dt * c.peak / c.ffs * 10.24
        }
    );
    // two at once
    t!(
        "50 break 10% masked by force gain +11%",
        d(),
        |c: &mut Ctx| if on(c) {
            c.cond.k = 0.9;
            c.cond.c = 0.9;
            *c.f *= 1.111
        }
    );
    t!(
        "51 break 10% while temperature reads +30C",
        d(),
        |c: &mut Ctx| if on(c) {
            c.cond.k = 0.9;
            c.cond.c = 0.9;
            *c.temp = 50.0
        }
    );
    t!(
        "52 preload 10% and friction wear 20% at once",
        d(),
        |c: &mut Ctx| if on(c) {
            c.cond.pre = 0.1 * c.peak;
            c.cond.c = 0.8
        }
    );
    t!(
        "53 one displacement spike (latches), then 20% break",
        d(),
        |c: &mut Ctx| {
            if (c.cyc * 5000.0).round() as i64 == 25 * 5000 + 1234 {
                *c.y += 0.5 * c.amp / c.yfs * 10.24
            }
            if on(c) {
                c.cond.k = 0.8;
                c.cond.c = 0.8
            }
        }
    );
    // actuator / DAC / clock
    t!(
        "60 servo force limit just below need",
        Opt {
            servo_limit: Some(0.15),
            cycles: 30,
            ..d()
        },
        |_| {}
    );
    t!(
        "61 DAC browns out at 30: 0 V for good",
        d(),
        |_| {},
        |_, c, v: &mut f64| if c > 30.0 {
            *v = 0.0
        },
        np
    );
    t!(
        "62 DAC holds last value from 30 (writes lost)",
        d(),
        |_| {},
        {
            let mut h = None;
            move |_: u64, c: f64, v: &mut f64| {
                if c > 30.0 {
                    *v = *h.get_or_insert(*v)
                }
            }
        },
        np
    );
    t!(
        "63 DAC gain halves at 30",
        d(),
        |_| {},
        |_, c, v: &mut f64| if c > 30.0 {
            *v *= 0.5
        },
        np
    );
    t!(
        "64 timer at half rate from 30 (plant steps twice a tick)",
        d(),
        |_| {},
        nd,
        |_, c, b: &mut Bench<Spec, 16, 1>| if c > 30.0 {
            let (v, e) = (b.dac.volts.get(), b.enabled.get());
            b.plant.advance(v, e)
        }
    );
    t!("65 tick stalls 50 ms once at 30.1", d(), |_| {}, nd, {
        let mut done = false;
        move |_: u64, c: f64, b: &mut Bench<Spec, 16, 1>| {
            if c > 30.1 && !done {
                done = true;
                let (v, e) = (b.dac.volts.get(), b.enabled.get());
                for _ in 0..500 {
                    b.plant.advance(v, e)
                }
            }
        }
    });
    t!(
        "66 timer at half rate from the start",
        d(),
        |_| {},
        nd,
        |_, _, b: &mut Bench<Spec, 16, 1>| {
            let (v, e) = (b.dac.volts.get(), b.enabled.get());
            b.plant.advance(v, e)
        }
    );
    t!(
        "67 one tick in three is lost from 30",
        d(),
        |_| {},
        nd,
        |t, c, b: &mut Bench<Spec, 16, 1>| if c > 30.0 && t % 2 == 0 {
            let (v, e) = (b.dac.volts.get(), b.enabled.get());
            b.plant.advance(v, e)
        }
    );
    // debounce of limits
    t!(
        "70 force seized to 3x limit but connector shows 0 one tick in ten",
        Opt {
            force_range: Some(1.2),
            flimit: Some(0.3),
            ..d()
        },
        |c: &mut Ctx| {
            if on(c) {
                c.cond.k = 3.0;
                c.cond.c = 3.0;
                if c.tick % 10 == 0 {
                    *c.f = 0.0
                }
            }
        }
    );
    t!(
        "70b same without the drop-outs",
        Opt {
            force_range: Some(1.2),
            flimit: Some(0.3),
            ..d()
        },
        |c: &mut Ctx| {
            if on(c) {
                c.cond.k = 3.0;
                c.cond.c = 3.0
            }
        }
    );
    t!("71 servo dead at 30", d(), |_| {}, nd, |_,
                                                c,
                                                b: &mut Bench<
        Spec,
        16,
        1,
    >| if c > 30.0 {
        b.plant.servo.fault = ServoFault::Dead
    });
    t!(
        "72 force 2x its limit, signal alternates there and 0.9 limit each 10th tick (ringing)",
        Opt {
            force_range: Some(1.2),
            flimit: Some(0.3),
            ..d()
        },
        |c: &mut Ctx| {
            if on(c) {
                c.cond.k = 3.0;
                c.cond.c = 3.0;
                if c.tick % 10 == 0 {
                    *c.f = c.f.clamp(-0.29 / c.ffs * 10.24, 0.29 / c.ffs * 10.24)
                }
            }
        }
    );
    t!(
        "73 displacement connector shows 0 one tick in ten while the sensor gain fades to 25%",
        Opt { cycles: 200, ..d() },
        |c: &mut Ctx| {
            if on(c) {
                *c.y *= (1.0 - 0.75 * (c.cyc - 30.0) / 100.0).max(0.25);
                if c.tick % 10 == 0 {
                    *c.y = 0.0
                }
            }
        }
    );
    t!(
        "74 displacement gain fades to 25% in 100 cycles",
        Opt { cycles: 200, ..d() },
        |c: &mut Ctx| {
            if on(c) {
                *c.y *= (1.0 - 0.75 * (c.cyc - 30.0) / 100.0).max(0.25)
            }
        }
    );
    t!(
        "75 force open with pickup, then specimen seizes x5 (limit 0.3)",
        Opt {
            force_range: Some(1.2),
            flimit: Some(0.3),
            ..d()
        },
        |c: &mut Ctx| {
            if on(c) {
                *c.f = 0.05 * (rnd(c.rng) - 0.5)
            }
            if c.cyc > 40.0 {
                c.cond.k = 5.0;
                c.cond.c = 5.0
            }
        }
    );
    t!(
        "76 clear after run: friction +20% w/o stiffness",
        Opt { freq: 0.5, ..d() },
        |c: &mut Ctx| if on(c) {
            c.cond.c = 1.2
        }
    );
    t!("77 stiffness +20%", d(), |c: &mut Ctx| if on(c) {
        c.cond.k = 1.2
    });
    t!("78 friction +50%", d(), |c: &mut Ctx| if on(c) {
        c.cond.c = 1.5
    });
    t!(
        "79 one force spike at 25 then force zero drift, then 40% break",
        Opt { cycles: 120, ..d() },
        |c: &mut Ctx| {
            if (c.cyc * 5000.0).round() as i64 == 25 * 5000 + 1234 {
                *c.f += 0.5 * c.peak / c.ffs * 10.24
            }
            if on(c) {
                c.cond.k = 0.6;
                c.cond.c = 0.6
            }
        }
    );
    let _ = SensorFault::None;
    let _ = Opt { skip: false, ..d() }.skip;
    let _ = |c: &Ctx| c.phase;
}
fn thread_drop(c: &mut Ctx, y: bool) {
    thread_local! { static LEFT: Cell<u32> = const { Cell::new(0) }; }
    if LEFT.get() > 0 {
        LEFT.set(LEFT.get() - 1);
        if y { *c.y = 0.0 } else { *c.f = 0.0 }
    } else if rnd(c.rng) < 0.002 {
        LEFT.set(1);
        if y { *c.y = 0.0 } else { *c.f = 0.0 }
    }
}
fn stuck_bit(v: f64, bit: u32) -> f64 {
    let code = (v / 10.24 * 32768.0 + 32768.5).clamp(0.0, 65535.0) as u32 & !(1 << bit);
    (code as f64 - 32768.0) / 32768.0 * 10.24
}

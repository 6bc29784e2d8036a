//! Every added effect against a closed form of another kind than its own recurrence.

mod backlash;
mod bouc_wen;
mod compliance;
mod control_input;
mod degradation;
mod directional;
mod every_effect;
mod force_filter;
mod hardening_friction;
mod load_friction;
mod loops;
mod outside;
mod refusals;
mod relaxation;
mod residual_table;
mod slow_changes;
mod stages;
mod stateless;
mod stick_slip;
mod stop_and_tone;
mod weakening;
mod yielding;

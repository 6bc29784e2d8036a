//! What is made of the list of effects: the one line that an effect has outside its own file.
//!
//! Forces are added in the order of the list, the light ones first, the rare ones last. A motion passes through the stages
//! in that order too.

/// Makes the module of each effect in the list, [`Effect`](super::Effect) over all of them, and the set of effects and of their
/// states that an [`AugmentedLaw`](super::AugmentedLaw) holds.
macro_rules! effects {
    ($($module:ident: $name:ident,)+) => {
        $(
            pub mod $module;
            pub use $module::$name;
        )+

        /// What each effect is, in the order in which their forces are added.
        pub const DESCRIPTIONS: &[Description] = &[
            $(<$name<f32> as Equations<f32>>::DESCRIPTION,)+
        ];

        /// Any one effect's configuration.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum Effect<R> {
            $(#[doc = concat!("See [`", stringify!($name), "`].")] $name($name<R>),)+
        }

        impl<R: Real> Effect<R> {
            /// The effect whose number in a pack is `number`, of `parameters` in the order of its description, element by
            /// element, for a tick of `tick` s.
            ///
            /// # Errors
            /// A number that no effect has; what the effect's constructor refuses.
            pub fn from_parameters(
                number: u8,
                parameters: &[f64],
                tick: f64,
            ) -> Result<Self, ConfigError> {
                $(if number == <$name<R> as Equations<R>>::DESCRIPTION.number {
                    return $name::from_parameters(parameters, tick).map(Self::$name);
                })+
                Err(unknown(number))
            }

            /// What it is.
            pub fn description(&self) -> Description {
                match self {
                    $(Self::$name(_) => <$name<R> as Equations<R>>::DESCRIPTION,)+
                }
            }

            /// Its bit, and the field that holds it.
            fn place(&self) -> (u32, &'static str) {
                match self {
                    $(Self::$name(_) => (Bit::$name.mask(), stringify!($module)),)+
                }
            }
        }

        impl Effect<f32> {
            /// Writes its number, how many words it has, and the words.
            pub(crate) fn pack(&self, writer: &mut Writer<'_>) {
                let mut words = heapless::Vec::<f32, MOST_WORDS>::new();
                // As many as there is room for.
                let mut put = |word| {
                    let _ = words.push(word);
                };
                let number = match self {
                    $(Self::$name(effect) => {
                        effect.pack(&mut put);
                        <$name<f32> as Equations<f32>>::DESCRIPTION.number
                    })+
                };
                // A length below 128 is one byte.
                writer.bytes(&[number, words.len() as u8]);
                for word in &words {
                    writer.f32(*word);
                }
            }

            /// Of the `number` and the words that [`Effect::pack`] wrote; the words are still to be checked. `None` where they are
            /// not those of an effect.
            pub(crate) fn unpack(number: u8, words: &[f32]) -> Option<Self> {
                $(if number == <$name<f32> as Equations<f32>>::DESCRIPTION.number {
                    return $name::unpack(words).map(Self::$name);
                })+
                None
            }

            /// Whether an effect has this number in a pack.
            pub(crate) fn is_known(number: u8) -> bool {
                $(number == <$name<f32> as Equations<f32>>::DESCRIPTION.number)||+
            }
        }

        /// The bit of each effect.
        #[derive(Clone, Copy)]
        enum Bit {
            $($name,)+
            ResidualTable,
        }

        impl Bit {
            const fn mask(self) -> u32 {
                1 << self as u32
            }
        }

        /// The bit of the correction, which counts among the effects as none.
        const CORRECTION: u32 = Bit::ResidualTable.mask();
        /// The bit of a law that is being written, which is that of no effect.
        const UNFINISHED: u32 = 1 << 31;
        const _: () = assert!(CORRECTION < UNFINISHED);
        const LIGHT: u32 = $(if is_cost(&<$name<f32> as Equations<f32>>::DESCRIPTION, Cost::Light) { Bit::$name.mask() } else { 0 })|+;
        const RARE: u32 = $(if is_cost(&<$name<f32> as Equations<f32>>::DESCRIPTION, Cost::Rare) { Bit::$name.mask() } else { 0 })|+;
        const SCALING: u32 = $(if <$name<f32> as Equations<f32>>::DESCRIPTION.scales_law { Bit::$name.mask() } else { 0 })|+;
        const HELD: u32 = $(if depends_on(&<$name<f32> as Equations<f32>>::DESCRIPTION, Dependence::Control)
            || depends_on(&<$name<f32> as Equations<f32>>::DESCRIPTION, Dependence::Cycle) { Bit::$name.mask() } else { 0 })|+;
        const WARMED: u32 = $(if depends_on(&<$name<f32> as Equations<f32>>::DESCRIPTION, Dependence::Temperature) { Bit::$name.mask() } else { 0 })|+;
        const SUPPLYING: u32 = $(if <$name<f32> as Equations<f32>>::DESCRIPTION.supplies_energy { Bit::$name.mask() } else { 0 })|+;
        const STAGES: u32 = $(if is_kind(&<$name<f32> as Equations<f32>>::DESCRIPTION, EffectKind::Stage) { Bit::$name.mask() } else { 0 })|+;

        /// Up to one effect of each kind.
        #[derive(Clone, Debug, PartialEq)]
        struct Effects<R> {
            /// The bits of those that are there, and of the correction.
            present: u32,
            $($module: $name<R>,)+
        }

        /// What the effects of an [`AugmentedLaw`] remember: nothing before the first tick.
        #[derive(Clone, Debug)]
        // The longest stands at the end of the list: the others are within reach of a load's offset.
        #[repr(C)]
        // A simulation that goes back writes it and reads it again.
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(
            feature = "serde",
            serde(bound(
                serialize = "R: serde::Serialize",
                deserialize = "R: serde::Deserialize<'de>"
            ))
        )]
        pub struct AugmentedState<R: Real> {
            $($module: <$name<R> as Equations<R>>::State,)+
            correction: ResidualTableState,
        }

        impl<R: Real> AugmentedState<R> {
            /// Before the first tick, whatever the effects are. All bits are 0.
            pub(crate) const AT_REST: Self = Self {
                $($module: <$name<R> as Equations<R>>::AT_REST,)+
                correction: ResidualTableState::NEW,
            };
        }

        impl<R: Real> Effects<R> {
            /// All bits are 0.
            const NONE: Self = Self {
                present: 0,
                $($module: <$name<R> as Equations<R>>::NONE,)+
            };

            fn add(&mut self, effect: Effect<R>) -> Result<(), ConfigError> {
                let (bit, field) = effect.place();
                if self.present & bit != 0 {
                    return Err(ConfigError::Full { field, capacity: 1 });
                }
                self.present |= bit;
                match effect {
                    $(Effect::$name(effect) => self.$module = effect,)+
                }
                Ok(())
            }

            /// [`Equations::check`] of the effect of this number.
            #[inline(never)]
            fn check(&self, number: u8) -> Result<(), ConfigError> {
                $(if number == <$name<R> as Equations<R>>::DESCRIPTION.number {
                    return self.$module.check();
                })+
                Ok(())
            }

            /// The bits of the effects.
            fn kinds(&self) -> u32 {
                self.present & !(CORRECTION | UNFINISHED)
            }

            #[inline(always)]
            fn has(&self, bit: u32) -> bool {
                self.present & bit != 0
            }

            /// It becomes `other`, one by one: a copy of all of them is too long for a small stack.
            #[inline(never)]
            fn copy_from(&mut self, other: &Self) {
                self.present = other.present;
                $(self.$module = other.$module;)+
            }

            /// [`Equations::at_half_rate`] of each that is there.
            #[inline(never)]
            fn halve_rate(&mut self) {
                $(if self.has(Bit::$name.mask()) {
                    self.$module = self.$module.at_half_rate();
                })+
            }

            fn iter(&self) -> impl Iterator<Item = Effect<R>> {
                [$(self.has(Bit::$name.mask()).then_some(Effect::$name(self.$module)),)+]
                    .into_iter()
                    .flatten()
            }

            /// `law` and every effect's force but those of the rare ones, kN.
            #[inline(always)]
            fn add_force(
                &self,
                state: &mut AugmentedState<R>,
                motion: &ClampedMotion<R>,
                law: LawForce<R>,
            ) -> R {
                let mut total = law.total;
                if self.present & LIGHT != 0 {
                    $(if LIGHT & Bit::$name.mask() != 0 {
                        total += self.$module.force(&mut state.$module, motion, law);
                    })+
                }
                $(if (LIGHT | RARE) & Bit::$name.mask() == 0 && self.has(Bit::$name.mask()) {
                    total += self.$module.force(&mut state.$module, motion, law);
                })+
                total
            }

            /// The sum of `force` and the rare effects' forces, kN.
            #[inline(always)]
            fn add_rare_force(
                &self,
                state: &mut AugmentedState<R>,
                motion: &ClampedMotion<R>,
                law: LawForce<R>,
                force: R,
            ) -> R {
                let mut total = force;
                if self.present & RARE & !STAGES != 0 {
                    $(if RARE & !STAGES & Bit::$name.mask() != 0 && self.has(Bit::$name.mask()) {
                        total += self.$module.force(&mut state.$module, motion, law);
                    })+
                }
                total
            }

            /// What the effects make of `law` alone, kN.
            // Not inlined: it is taken twice, and not every tick.
            #[inline(never)]
            fn scaled(&self, motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
                let mut total = law.total;
                $(if SCALING & Bit::$name.mask() != 0 && self.has(Bit::$name.mask()) {
                    total += self.$module.force_of_law(motion, law);
                })+
                total
            }

            /// [`AugmentedLaw::force_through_stages`] without the correction.
            #[inline(always)]
            fn force_through_stages(
                &self,
                state: &mut AugmentedState<R>,
                motion: &ClampedMotion<R>,
                law: &Law<R>,
                damping: impl Fn(R) -> R,
            ) -> R {
                let mut motion = *motion;
                $(if STAGES & Bit::$name.mask() != 0 && self.has(Bit::$name.mask()) {
                    motion = self.$module.felt(&motion);
                })+
                let viscous = self.viscous.viscous();
                let mut solved = None;
                $(if STAGES & Bit::$name.mask() != 0 && self.has(Bit::$name.mask())
                    && let Some((seen, force)) =
                        self.$module.solved(&mut state.$module, &motion, law, viscous, &damping)
                {
                    motion = seen;
                    solved = Some(force);
                })+
                let law = match solved {
                    Some(law) => law,
                    None => LawForce::of(law, &motion, damping),
                };
                let force = self.add_force(state, &motion, law);
                let force = self.add_rare_force(state, &motion, law, force);
                let mut shown = force;
                $(if STAGES & Bit::$name.mask() != 0 && self.has(Bit::$name.mask()) {
                    self.$module.added(&mut state.$module, force - law.total, viscous);
                    shown = self.$module.shown(&mut state.$module, shown);
                })+
                shown
            }
        }
    };
}

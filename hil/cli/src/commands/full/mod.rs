//! The commands that a build without the feature `full` leaves out: they need the image, the paper, the trials or a page.

mod amplitude_independent;
mod batch;
mod bench;
mod bench_table;
mod blind;
mod blind_conditions;
mod blind_text;
mod board;
mod characterize;
mod compare;
mod completions;
mod cycles;
mod design;
mod drive;
mod effect;
mod emulate;
mod events;
mod export;
mod faults;
mod faults_text;
mod fmu_library;
mod image;
mod junit;
mod law;
mod live;
mod meant_for;
mod orthogonal;
mod pace;
mod pack;
mod paper;
pub mod policy;
pub mod predict_on;
mod programme;
mod record;
mod run;
mod schema;
mod specimen;
mod stop;
mod study;
mod study_bouc_wen;
mod study_size;
mod upload;

use clap::Subcommand;

use super::Failure;

/// See [`super::Cli`]. The order is that of `docs/commands.md`.
#[derive(Debug, Subcommand)]
pub enum Command {
    Batch(batch::BatchCommand),
    Compare(compare::CompareCommand),
    Export(export::ExportCommand),
    Run(run::RunCommand),
    Record(record::RecordCommand),
    Upload(upload::UploadCommand),
    Stop(stop::StopCommand),
    Emulate(emulate::EmulateCommand),
    Faults(faults::FaultsCommand),
    AmplitudeFree(amplitude_independent::AmplitudeFreeCommand),
    Characterize(characterize::CharacterizeCommand),
    Orthogonal(orthogonal::OrthogonalCommand),
    Design(design::DesignCommand),
    Paper(paper::PaperCommand),
    Blind(blind::BlindCommand),
    Study(study::StudyCommand),
    Bench(bench::BenchCommand),
    Schema(schema::SchemaCommand),
    Completions(completions::CompletionsCommand),
    Man(completions::ManCommand),
}

impl Command {
    /// Runs the command.
    pub fn run(self) -> Result<(), Failure> {
        match self {
            Self::Batch(command) => command.run(),
            Self::Compare(command) => command.run(),
            Self::Export(command) => command.run(),
            Self::Run(command) => command.run(),
            Self::Record(command) => command.run(),
            Self::Upload(command) => command.run(),
            Self::Stop(command) => command.run(),
            Self::Emulate(command) => command.run(),
            Self::Faults(command) => command.run(),
            Self::AmplitudeFree(command) => command.run(),
            Self::Characterize(command) => command.run(),
            Self::Orthogonal(command) => command.run(),
            Self::Design(command) => command.run(),
            Self::Paper(command) => command.run(),
            Self::Blind(command) => command.run(),
            Self::Study(command) => command.run(),
            Self::Bench(command) => command.run(),
            Self::Schema(command) => command.run(),
            Self::Completions(command) => command.run(),
            Self::Man(command) => command.run(),
        }
    }
}

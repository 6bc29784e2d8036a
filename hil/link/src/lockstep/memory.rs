//! Memory that the harness shares with an emulated board: [`mesh_damper_firmware::shared_memory`] documents its layout.

use std::fmt::{self, Debug, Formatter};
use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::ops::Deref;
use std::os::fd::AsFd;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::{Acquire, Relaxed, Release, SeqCst};
use std::time::{Duration, Instant};

use mesh_damper::frame::LARGEST;
use mesh_damper_firmware::shared_memory::{
    ANSWERS, ANSWERS_TAKEN, BYTES, FRAME, HARNESS_SLEEPS, IMAGE_SLEEPS, PATIENCE, REQUESTS,
    REQUESTS_TAKEN, SLOT, WORDS, has_room, slot,
};
use mesh_damper_output::scratch::Scratch;
use mmap_io::MemoryMappedFile;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

/// Number of times that either end looks for the other's next frame before it sleeps: some 100 µs, twice as long as it takes to
/// wake a processor. A look takes the harness 20 ns, and the image 5 ns.
const LOOKS: u32 = 5_000;
const LOOKS_OF_IMAGE: u32 = 20_000;
/// Time that a frame saves on two processors compared with one, as in docs/bench.md. If this end slept for longer than that, over
/// [`FRAMES`] of them, other programs keep the processors busy. Then both ends sleep at once, on one processor, for the next
/// [`TOGETHER`] frames, a fifth of a second.
const SAVED: Duration = Duration::from_micros(7);
const FRAMES: u32 = 1024;
const TOGETHER: u32 = 16_384;
/// Time after which the harness checks again whether it was woken, ms.
const SLEEP: Duration = Duration::from_millis(2);

/// The memory, and the counts of frames sent and taken, which are the harness's own.
pub(super) struct SharedMemory {
    map: MemoryMappedFile,
    /// The folder with its file, until the emulator has it too.
    folder: Option<Scratch>,
    sent: u32,
    taken: u32,
    /// Whether each end has a processor of its own, for how many frames, and how long this end has slept meanwhile.
    apart: bool,
    frames: u32,
    slept: Duration,
}

impl Debug for SharedMemory {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("SharedMemory");
        shown.field("folder", &self.folder).finish_non_exhaustive()
    }
}

/// Folder of files in memory, on Linux; elsewhere the folder for temporary files is used.
const IN_MEMORY: &str = "/dev/shm";
/// Name of the file.
const FILE: &str = "memory";

impl SharedMemory {
    /// Memory for an emulator to be started.
    ///
    /// # Errors
    /// The file cannot be created.
    pub(super) fn new() -> io::Result<Self> {
        let folder = Some(PathBuf::from(IN_MEMORY)).filter(|folder| folder.is_dir());
        let folder = folder.unwrap_or_else(std::env::temp_dir);
        let folder = Scratch::within(&folder)?;
        let file = folder.path().join(FILE);
        File::create(&file)?.set_len(BYTES as u64)?;
        let memory = Self {
            map: MemoryMappedFile::open_rw(&file).map_err(io::Error::other)?,
            folder: Some(folder),
            sent: 0,
            taken: 0,
            apart: true,
            frames: 0,
            slept: Duration::ZERO,
        };
        memory.words()[PATIENCE].store(LOOKS_OF_IMAGE, Relaxed);
        Ok(memory)
    }

    /// Arguments for the emulator that make it the board's memory.
    pub(super) fn arguments(&self) -> [String; 4] {
        let folder = self.folder.as_ref().map_or(Path::new(""), Scratch::path);
        // A comma in the path would end it.
        let path = folder.join(FILE).display().to_string().replace(',', ",,");
        [
            "-object".into(),
            format!("memory-backend-file,id=shared,share=on,size={BYTES},mem-path={path}"),
            "-machine".into(),
            "memory-backend=shared".into(),
        ]
    }

    fn words(&self) -> impl Deref<Target = [AtomicU32]> {
        let Ok(words) = self.map.atomic_u32_slice(0, WORDS) else {
            unreachable!("it is as long, and nobody has another view of it");
        };
        words
    }

    /// Sends `frame`; a frame without room is lost.
    pub(super) fn send(&mut self, frame: &[u8]) {
        let words = self.words();
        let taken = words[REQUESTS_TAKEN].load(Acquire);
        if !has_room(self.sent, taken) || frame.len() > LARGEST {
            return;
        }
        let sent = self.sent.wrapping_add(1);
        let slot = &words[slot(REQUESTS, sent)..][..SLOT];
        slot[1].store(frame.len() as u32, Relaxed);
        for (word, bytes) in slot[FRAME..].iter().zip(frame.chunks(4)) {
            let mut padded = [0; 4];
            padded[..bytes.len()].copy_from_slice(bytes);
            word.store(u32::from_le_bytes(padded), Relaxed);
        }
        slot[0].store(sent, Release);
        drop(words);
        self.sent = sent;
    }

    /// Waits for the next bytes, and returns how many of them it wrote to `buffer`; 0 if none come. `bell` wakes the image, and
    /// bytes through `own_bell` wake this end.
    ///
    /// # Errors
    /// The emulator is gone.
    pub(super) fn receive(
        &mut self,
        buffer: &mut [u8],
        bell: &mut impl Write,
        own_bell: &mut (impl Read + AsFd),
    ) -> io::Result<usize> {
        let words = self.words();
        let answered = || next_of(&words, self.taken).is_some();
        let sleeps = || words[IMAGE_SLEEPS].load(Acquire) != 0;
        let looks = if self.apart { LOOKS } else { 0 };
        let mut rung = false;
        let mut slept = Duration::ZERO;
        while !answered() {
            // In this order: the image says that it sleeps after it has answered all that it has taken.
            let all_taken = words[REQUESTS_TAKEN].load(Acquire) == self.sent;
            if sleeps() {
                if all_taken && !answered() {
                    return Ok(0);
                } else if !rung {
                    bell.write_all(&[0])?;
                    rung = true;
                }
            }
            let moved = || answered() || (!rung && sleeps());
            if (0..looks).any(|_| {
                std::hint::spin_loop();
                moved()
            }) {
                continue;
            }
            words[HARNESS_SLEEPS].store(1, SeqCst);
            let began = self.apart.then(Instant::now);
            if !answered() && !sleep(own_bell)? {
                // If the bell was heard before the request was there, it is rung again.
                rung = false;
            }
            words[HARNESS_SLEEPS].store((!self.apart).into(), Relaxed);
            slept += began.map_or(Duration::ZERO, |began| began.elapsed());
        }
        let (taken, filled) = take(&words, self.taken, buffer);
        drop(words);
        self.taken = taken;
        // An image that answers has opened the file.
        self.folder.take();
        // The first frames wait for the emulator, which starts and then translates the image; their times say nothing about the
        // processors.
        if taken > FRAMES {
            self.slept += slept;
        }
        Ok(filled)
    }

    /// Whether harness and image must be on two processors from now on, or on one; `None` for no change.
    pub(super) fn judge(&mut self) -> Option<bool> {
        self.frames += 1;
        let lost = self.slept > SAVED * FRAMES;
        if !lost && self.frames < if self.apart { FRAMES } else { TOGETHER } {
            return None;
        }
        (self.frames, self.slept) = (0, Duration::ZERO);
        // After a while on one processor two are tried again.
        let apart = !(self.apart && lost);
        if apart == self.apart {
            return None;
        }
        self.apart = apart;
        let words = self.words();
        words[PATIENCE].store(if apart { LOOKS_OF_IMAGE } else { 1 }, Relaxed);
        words[HARNESS_SLEEPS].store((!apart).into(), Relaxed);
        drop(words);
        Some(apart)
    }
}

/// Slot of the answer after the first `taken` ones, if it is there.
fn next_of(words: &[AtomicU32], taken: u32) -> Option<&[AtomicU32]> {
    let count = taken.wrapping_add(1);
    let slot = &words[slot(ANSWERS, count)..][..SLOT];
    (slot[0].load(Acquire) == count).then_some(slot)
}

/// Takes all answers after the first `taken` ones into `buffer`; returns their number, and their length in bytes.
fn take(words: &[AtomicU32], mut taken: u32, buffer: &mut [u8]) -> (u32, usize) {
    let mut filled = 0;
    while let Some(slot) = next_of(words, taken) {
        let place = &mut buffer[filled..];
        let length = slot[1].load(Relaxed) as usize;
        let length = length.min(LARGEST).min(place.len());
        for (bytes, word) in place[..length].chunks_mut(4).zip(&slot[FRAME..]) {
            let word = word.load(Relaxed).to_le_bytes();
            bytes.copy_from_slice(&word[..bytes.len()]);
        }
        filled += length;
        taken = taken.wrapping_add(1);
    }
    words[ANSWERS_TAKEN].store(taken, Release);
    (taken, filled)
}

/// Sleeps until a byte comes through `bell`, at most for [`SLEEP`]; returns whether one came.
fn sleep(bell: &mut (impl Read + AsFd)) -> io::Result<bool> {
    let longest = Timespec::try_from(SLEEP).ok();
    match poll(&mut [PollFd::new(bell, PollFlags::IN)], longest.as_ref()) {
        Ok(0) | Err(Errno::INTR) => return Ok(false),
        Ok(_) => {}
        Err(error) => return Err(error.into()),
    }
    match bell.read(&mut [0; 64]) {
        Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
        Err(error) if error.kind() != ErrorKind::Interrupted => Err(error),
        _ => Ok(true),
    }
}

#[cfg(test)]
mod tests {
    use std::io::{PipeReader, PipeWriter, pipe};

    use mesh_damper_firmware::shared_memory::SLOTS;

    use super::*;

    /// The harness's end, and the image's end operated by hand.
    struct Link {
        memory: SharedMemory,
        to_image: (PipeReader, PipeWriter),
        to_harness: (PipeReader, Option<PipeWriter>),
        answers: u32,
    }

    impl Link {
        fn new() -> Self {
            let (reader, writer) = pipe().unwrap();
            Self {
                memory: SharedMemory::new().unwrap(),
                to_image: pipe().unwrap(),
                to_harness: (reader, Some(writer)),
                answers: 0,
            }
        }

        fn set(&self, at: usize, value: u32) {
            self.memory.words()[at].store(value, SeqCst);
        }

        fn answer(&mut self, word: u32) {
            self.answers += 1;
            let at = slot(ANSWERS, self.answers);
            self.set(at + FRAME, word);
            self.set(at + 1, 4);
            self.set(at, self.answers);
        }

        fn receive(&mut self) -> io::Result<Vec<u8>> {
            let mut buffer = [0; 64];
            let (bell, own_bell) = (&mut self.to_image.1, &mut self.to_harness.0);
            let came = self.memory.receive(&mut buffer, bell, own_bell)?;
            Ok(buffer[..came].to_vec())
        }
    }

    #[test]
    fn a_frame_lies_in_its_slot_and_one_without_a_slot_is_lost() {
        let mut link = Link::new();
        for byte in 0..10 {
            link.memory.send(&[byte; 5]);
        }
        let counts = |link: &Link| -> Vec<u32> {
            let words = link.memory.words();
            (0..SLOTS)
                .map(|count| words[slot(REQUESTS, count)].load(Relaxed))
                .collect()
        };
        assert_eq!(counts(&link), [0, 1, 2, 3, 4, 5, 6, 7]);
        let third = slot(REQUESTS, 3);
        let words: Vec<u32> = link.memory.words()[third..third + 4]
            .iter()
            .map(|word| word.load(Relaxed))
            .collect();
        assert_eq!(words, [3, 5, 0x0202_0202, 0x02]);
        link.set(REQUESTS_TAKEN, 2);
        link.memory.send(&[10]);
        assert_eq!(counts(&link), [8, 1, 2, 3, 4, 5, 6, 7]);
        link.memory.send(&[0; LARGEST + 1]);
        assert_eq!(counts(&link)[1], 1);
    }

    #[test]
    fn all_answers_come_in_order_and_an_image_with_no_more_to_say_is_not_waited_for() {
        let mut link = Link::new();
        link.memory.send(b"ask");
        for word in 1..4 {
            link.answer(word);
        }
        link.set(REQUESTS_TAKEN, 1);
        link.set(IMAGE_SLEEPS, 1);
        assert_eq!(
            link.receive().unwrap(),
            [1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0]
        );
        assert_eq!(link.memory.words()[ANSWERS_TAKEN].load(Relaxed), 3);
        assert!(link.receive().unwrap().is_empty());
    }

    #[test]
    fn an_image_that_sleeps_beside_a_request_is_woken_once_a_sleep() {
        let mut link = Link::new();
        link.memory.send(b"ask");
        link.set(IMAGE_SLEEPS, 1);
        let began = Instant::now();
        std::thread::scope(|scope| {
            let mut bell = link.to_image.0.try_clone().unwrap();
            let mut own_bell = link.to_harness.1.take().unwrap();
            let map =
                MemoryMappedFile::open_rw(link.memory.folder.as_ref().unwrap().path().join(FILE))
                    .unwrap();
            scope.spawn(move || {
                let rung = bell.read(&mut [0; 4096]).unwrap();
                // On a busy machine this thread begins late, and the harness has slept and rung again meanwhile.
                let sleeps = began.elapsed().as_nanos() / SLEEP.as_nanos();
                assert!(
                    (1..=1 + sleeps).contains(&(rung as u128)),
                    "{rung}, {sleeps}"
                );
                let words = map.atomic_u32_slice(0, WORDS).unwrap();
                words[IMAGE_SLEEPS].store(0, SeqCst);
                words[REQUESTS_TAKEN].store(1, SeqCst);
                // It answers only once this end sleeps.
                while words[HARNESS_SLEEPS].load(SeqCst) == 0 {}
                let at = slot(ANSWERS, 1);
                words[at + 1].store(3, SeqCst);
                words[at].store(1, SeqCst);
                own_bell.write_all(&[0]).unwrap();
            });
            assert_eq!(link.receive().unwrap(), [0; 3]);
        });
        // The time of the first frames does not count.
        assert_eq!(link.memory.slept, Duration::ZERO);
        assert!(link.memory.folder.is_none());
        assert_eq!(link.memory.words()[HARNESS_SLEEPS].load(Relaxed), 0);
    }

    #[test]
    fn an_emulator_that_is_gone_is_an_error_and_not_waited_for() {
        let mut link = Link::new();
        link.memory.send(b"ask");
        drop(link.to_harness.1.take());
        let error = link.receive().unwrap_err();
        assert_eq!(error.kind(), ErrorKind::UnexpectedEof);
    }

    #[test]
    fn where_sleep_takes_more_than_two_processors_save_both_are_on_one_for_a_while() {
        let mut link = Link::new();
        let judged = |memory: &mut SharedMemory, frames: u32| -> Vec<bool> {
            (0..frames).filter_map(|_| memory.judge()).collect()
        };
        // Not more, twice: each of these times counts separately.
        for _ in 0..2 {
            link.memory.slept = SAVED * FRAMES;
            assert!(judged(&mut link.memory, FRAMES).is_empty());
        }
        link.memory.slept = SAVED * FRAMES + Duration::from_nanos(1);
        assert_eq!(judged(&mut link.memory, 1), [false]);
        let shown = |link: &Link| {
            [PATIENCE, HARNESS_SLEEPS].map(|at| link.memory.words()[at].load(Relaxed))
        };
        assert_eq!(shown(&link), [1, 1]);
        assert!(judged(&mut link.memory, TOGETHER - 1).is_empty());
        assert_eq!(judged(&mut link.memory, 1), [true]);
        assert_eq!(shown(&link), [LOOKS_OF_IMAGE, 0]);
        assert!(judged(&mut link.memory, FRAMES).is_empty());
    }
}

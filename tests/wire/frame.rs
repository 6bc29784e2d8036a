//! Frames of the link: a written frame is read, and nothing else is.

use mesh_damper::frame::{Frame, FrameBuffer, Frames, Header, LARGEST, PAYLOAD};
use mesh_damper::message::{Answer, Refusal, Request, Sensors, write_done, write_refusal};
use proptest::prelude::*;

fn written(header: Header, payload: &[u8]) -> Vec<u8> {
    let mut buffer = FrameBuffer::new();
    buffer.write(header, |writer| writer.bytes(payload));
    buffer.bytes().to_vec()
}

fn header() -> impl Strategy<Value = Header> {
    (any::<u8>(), any::<u32>(), any::<u16>()).prop_map(|(kind, sequence, count)| Header {
        kind,
        sequence,
        count,
    })
}

fn payload() -> impl Strategy<Value = Vec<u8>> {
    prop::collection::vec(any::<u8>(), 0..=PAYLOAD)
}

#[test]
fn what_does_not_fit_is_no_frame() {
    assert_eq!(written(Header::default(), &[1; PAYLOAD]).len(), LARGEST);
    assert!(written(Header::default(), &[1; PAYLOAD + 1]).is_empty());
}

#[test]
fn requests_and_answers_are_what_they_were() {
    let mut buffer = FrameBuffer::new();
    let request = Request::Tick(Sensors {
        displacement: 0x1234,
        force: 0xFEDC,
        temperature: -0.0,
        controls: [1.5, -0.0, f32::MIN_POSITIVE, f32::INFINITY],
        clock: u32::MAX - 1,
        tripped: true,
    });
    for request in [
        request,
        Request::PackPart(7, b"part"),
        Request::PackEnd,
        Request::Start,
        Request::Stop,
        Request::Clear,
        Request::Rest,
        Request::Statistics,
    ] {
        request.write(9, &mut buffer);
        let frame = Frames(buffer.bytes()).next().unwrap();
        assert_eq!((frame.header.sequence, frame.header.count), (9, 1));
        assert_eq!(Request::read(&frame), Some(request));
        assert_eq!(Answer::read(&frame), None);
    }
    for refusal in [
        Refusal::Order,
        Refusal::PackChecksum,
        Refusal::Field("glide"),
    ] {
        write_refusal(3, &refusal, &mut buffer);
        let frame = Frames(buffer.bytes()).next().unwrap();
        assert_eq!(Answer::read(&frame), Some(Answer::Refused(refusal)));
        assert_eq!(Request::read(&frame), None);
    }
    write_done(3, false, &mut buffer);
    let frame = Frames(buffer.bytes()).next().unwrap();
    assert_eq!(Answer::read(&frame), Some(Answer::Done(false)));
}

proptest! {
    #[test]
    fn frames_are_found_in_order_whatever_lies_between_them(
        frames in prop::collection::vec((header(), payload()), 0..5),
        noise in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..40), 6),
    ) {
        let mut bytes = noise[0].clone();
        for ((header, payload), noise) in frames.iter().zip(&noise[1..]) {
            bytes.extend(written(*header, payload));
            bytes.extend(noise);
        }
        let found: Vec<Frame<'_>> = Frames(&bytes).collect();
        prop_assert_eq!(found.len(), frames.len());
        for (found, (header, payload)) in found.iter().zip(&frames) {
            prop_assert_eq!(&found.header, header);
            prop_assert_eq!(found.payload, &payload[..]);
        }
    }

    #[test]
    fn a_frame_with_one_bit_changed_or_cut_is_none(
        header in header(), payload in payload(), place in any::<prop::sample::Index>(), bit in 0..8,
    ) {
        let good = written(header, &payload);
        let mut changed = good.clone();
        changed[place.index(good.len())] ^= 1u8 << bit;
        prop_assert_eq!(Frames(&changed).next(), None);
        prop_assert_eq!(Frames(&good[..place.index(good.len())]).next(), None);
    }

    /// The frame after a truncated one is found, although the truncated one takes its beginning for its own end.
    #[test]
    fn a_frame_after_one_that_was_cut_is_found(
        header in header(), payload in payload(), cut in any::<prop::sample::Index>(),
    ) {
        let good = written(header, &payload);
        let mut bytes = good[..cut.index(good.len())].to_vec();
        bytes.extend(&good);
        prop_assert_eq!(Frames(&bytes).count(), 1);
    }

    #[test]
    fn any_bytes_are_no_request_that_panics(kind in any::<u8>(), payload in payload()) {
        let bytes = written(Header { kind, sequence: 0, count: 1 }, &payload);
        let frame = Frames(&bytes).next().unwrap();
        let _ = Request::read(&frame);
        let _ = Answer::read(&frame);
    }
}

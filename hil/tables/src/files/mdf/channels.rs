//! The channels of a file, in groups whose records have all of them.

use std::collections::HashMap;
use std::rc::Rc;

use falcon_mdf::Mf4Error;
use falcon_mdf::blocks::{CgBlock, ChannelType, CnBlock, DgBlock, SyncType};
use falcon_mdf::parser::links::LinkChain;

use super::blocks::Blocks;
use super::conversion::{Conversion, Conversions};
use super::elements::Elements;
use super::field::Field;
use super::records::{self, Among, Block, Kept, Layout};
use crate::files::DEEPEST;
use crate::files::refused::Refused;

const PART: &str = "its channels";

/// A group of data: the blocks with the records of its groups of channels.
pub(super) struct Data {
    pub list: Vec<Block>,
    /// Bytes of the number before a record.
    pub width: usize,
    /// Where the records of each of its groups begin, if they lie among each other.
    pub places: Option<Vec<Vec<usize>>>,
}

/// A group of channels.
pub(super) struct Group {
    /// Its group of data, and its place in it.
    pub data: usize,
    pub place: usize,
    pub name: Rc<str>,
    pub samples: u64,
    pub layout: Layout,
    /// Whether it has the frames of a bus, or texts of other channels.
    pub is_other: bool,
    among: Among,
    pub channels: Vec<Channel>,
}

/// A channel.
pub(super) struct Channel {
    pub name: Rc<str>,
    pub unit: Rc<str>,
    pub is_time: bool,
    /// Whether its raw values are the numbers of the records.
    pub is_virtual: bool,
    pub field: Field,
    pub conversion: Rc<Conversion>,
    /// Whether all its values are invalid, or the bit that says so in a record.
    pub is_invalid: bool,
    pub invalid: Option<u32>,
    pub elements: Option<Elements>,
    /// Why it is not read, if it is not.
    pub unread: Option<&'static str>,
}

/// All channels of a file.
#[derive(Default)]
pub(super) struct Channels {
    pub data: Vec<Data>,
    pub groups: Vec<Group>,
    /// The groups by the links to them; by the link to a group of data, its first one.
    pub at: HashMap<u64, usize>,
}

impl Channels {
    /// The channels of the groups of data from the first on.
    pub fn of(
        blocks: &Blocks,
        kept: &Kept,
        first: u64,
        is_unfinished: bool,
    ) -> Result<Self, Refused> {
        let mut channels = Self::default();
        let conversions = Conversions::new();
        let mut link = first;
        // A block belongs to one other, so that none is reached twice.
        let mut visited = LinkChain::new();
        while link != 0 {
            let size = size_of::<Data>() + 2 * size_of::<(u64, usize)>();
            blocks.budget.hold(2 * size as u64, PART)?;
            visited.visit(link, "dg_next")?;
            let block: DgBlock = blocks.block(link)?;
            let from = channels.groups.len();
            channels.at.entry(link).or_insert(from);
            channels.of_data(blocks, &conversions, &mut visited, link, block.cg_first)?;
            let groups = &mut channels.groups[from..];
            let layouts: Vec<Layout> = groups.iter().map(|group| group.layout).collect();
            let mut data = Data {
                list: records::list(blocks, block.data, is_unfinished, &layouts)?,
                width: usize::from(block.rec_id_size),
                places: None,
            };
            count(blocks, kept, channels.data.len(), &mut data, groups)?;
            channels.data.push(data);
            link = block.dg_next;
        }
        Ok(channels)
    }

    /// The groups of channels of the group of data at a link.
    fn of_data(
        &mut self,
        blocks: &Blocks,
        conversions: &Conversions,
        visited: &mut LinkChain,
        data: u64,
        first: u64,
    ) -> Result<(), Refused> {
        let from = self.groups.len();
        let mut link = first;
        while link != 0 {
            let size = size_of::<Group>() + 2 * size_of::<(u64, usize)>();
            blocks.budget.hold(2 * size as u64, PART)?;
            visited.visit(link, "cg_next")?;
            let block: CgBlock = blocks.block(link)?;
            let layout = Layout {
                values: block.data_bytes as usize,
                invalid: block.inval_bytes as usize,
            };
            let mut members = Members {
                blocks,
                conversions,
                visited,
                around: [data, link],
                record: layout.values + layout.invalid,
                channels: Vec::new(),
            };
            members.chain(block.cn_first, "", DEEPEST)?;
            self.at.entry(link).or_insert(self.groups.len());
            self.groups.push(Group {
                data: self.data.len(),
                place: self.groups.len() - from,
                name: blocks.text(block.tx_acq_name)?,
                samples: block.cycle_count,
                layout,
                is_other: block.flags.vlsd || block.flags.plain_bus_event,
                among: Among {
                    number: block.record_id,
                    size: layout.values + layout.invalid,
                    is_of_any_length: block.flags.vlsd,
                },
                channels: members.channels,
            });
            link = block.cg_next;
        }
        Ok(())
    }
}

/// Counts the samples of the groups of a group of data: what the file says about them is believed no more than its records are there.
fn count(
    blocks: &Blocks,
    kept: &Kept,
    index: usize,
    data: &mut Data,
    groups: &mut [Group],
) -> Result<(), Refused> {
    if data.width > 0 && groups.len() > 1 {
        let among: Vec<Among> = groups.iter().map(|group| group.among).collect();
        let layout = groups[0].layout;
        let stream = kept.stream(blocks, index, &data.list, layout)?;
        let places = records::places(blocks, stream.bytes(blocks), data.width, &among)?;
        for (group, places) in groups.iter_mut().zip(&places) {
            group.samples = places.len() as u64;
        }
        data.places = Some(places);
    } else if !data.list.is_empty() {
        let bytes = records::size(&data.list);
        for group in groups {
            let record = (data.width + group.among.size) as u64;
            let most = bytes.checked_div(record).unwrap_or(0);
            if group.samples == 0 || group.samples > most {
                group.samples = most;
            }
        }
    }
    Ok(())
}

/// The channels of one group.
struct Members<'b> {
    blocks: &'b Blocks,
    conversions: &'b Conversions,
    visited: &'b mut LinkChain,
    /// Links to the group of data and to the group.
    around: [u64; 2],
    /// Bytes of a record.
    record: usize,
    channels: Vec<Channel>,
}

impl Members<'_> {
    /// The channels from a link on, which are parts of the channel `parent` unless that is empty.
    fn chain(&mut self, first: u64, parent: &str, depth: usize) -> Result<(), Refused> {
        let Some(depth) = depth.checked_sub(1) else {
            let chain = "cn_composition".to_owned();
            return Err(Mf4Error::CyclicLink {
                chain,
                offset: first,
            }
            .into());
        };
        let mut link = first;
        while link != 0 {
            let size = size_of::<Channel>() + 2 * size_of::<u64>();
            self.blocks.budget.hold(2 * size as u64, PART)?;
            self.visited.visit(link, "cn_next or cn_composition")?;
            let block: CnBlock = self.blocks.block(link)?;
            let name = self.name(parent, self.blocks.text(block.tx_name)?)?;
            let mut channel = self.channel(&block, name.clone())?;
            let mut inner = block.composition;
            if inner != 0 {
                match &self.blocks.head(inner)?.block_type {
                    b"##CN" => {}
                    b"##CA" => {
                        self.array(&mut channel, inner)?;
                        inner = 0;
                    }
                    _ => inner = 0,
                }
            }
            self.channels.push(channel);
            if inner != 0 {
                self.chain(inner, &name, depth)?;
            }
            link = block.cn_next;
        }
        Ok(())
    }

    /// The name of a part of `parent`. Some programs write it in whole, others without that of the parent.
    fn name(&self, parent: &str, name: Rc<str>) -> Result<Rc<str>, Refused> {
        self.blocks
            .budget
            .work((parent.len().min(name.len()) / 8) as u64, PART)?;
        let is_whole = parent.is_empty()
            || *name == *parent
            || (name.strip_prefix(parent)).is_some_and(|rest| rest.starts_with('.'));
        if is_whole {
            return Ok(name);
        }
        self.blocks
            .budget
            .hold((parent.len() + name.len() + 1) as u64, PART)?;
        Ok(match name.is_empty() {
            true => parent.into(),
            false => format!("{parent}.{name}").into(),
        })
    }

    fn channel(&self, block: &CnBlock, name: Rc<str>) -> Result<Channel, Refused> {
        let field = Field::of(block);
        let conversion = self.conversions.at(self.blocks, block.cc_conversion)?;
        let kind = block.channel_type;
        let is_virtual = kind.is_virtual();
        let unread = match kind {
            ChannelType::VariableLength | ChannelType::MaxLength => Some("values of any length"),
            _ if conversion.is_of_texts() => None,
            _ if is_virtual => conversion.unread(),
            _ => field.unread().or(conversion.unread()),
        };
        let is_outside = !is_virtual && field.at.saturating_add(field.width()) > self.record;
        Ok(Channel {
            name,
            unit: self.blocks.text(block.md_unit)?,
            is_time: kind.is_master() && block.sync_type == SyncType::Time,
            is_virtual,
            field,
            conversion,
            is_invalid: block.flags.all_invalid,
            invalid: block.flags.invalidation_bit.then_some(block.inval_bit_pos),
            elements: None,
            unread: unread.or(is_outside.then_some("values beyond its record")),
        })
    }

    /// Makes a channel an array.
    fn array(&self, channel: &mut Channel, link: u64) -> Result<(), Refused> {
        match Elements::at(self.blocks, link, &channel.field, self.around)? {
            Ok(elements) if elements.groups.is_empty() && !elements.fit(self.record) => {
                channel.unread = Some("arrays beyond their record");
            }
            Ok(elements) => {
                channel.unread = channel.conversion.unread();
                channel.elements = Some(elements);
            }
            Err(why) => channel.unread = Some(why),
        }
        Ok(())
    }
}

//! The resources that an image takes, read from its ELF file.

use object::elf::{SHF_ALLOC, SHT_NOBITS};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags};
use std::path::Path;

/// Where the RAM of an STM32 begins; below are the flash and what is loaded into it.
const RAM: u64 = 0x2000_0000;

/// Where the ESP32-C3 reads its flash: constants, then code.
const MAPPED_FLASH: [std::ops::Range<u64>; 2] = [0x3c00_0000..0x3c80_0000, 0x4200_0000..0x4280_0000];

/// Sections of the ESP32-C3 that keep places free: the stack, and what lies elsewhere under two
/// addresses.
const KEPT_FREE: [&str; 3] = [".stack", ".rwdata_dummy", ".rotext_dummy"];

/// The sizes and symbols of an image.
#[derive(Clone, Debug)]
pub struct Elf {
    /// Bytes of flash: code, constants, and the initial values of statics.
    pub flash: u64,
    /// Bytes of RAM for statics; the stack has its own region.
    pub ram: u64,
    /// The names of all symbols, mangled.
    pub symbols: Vec<String>,
    /// The bytes of each of them.
    sizes: Vec<u64>,
    /// The value of each of them: for most an address.
    values: Vec<u64>,
    /// The source files that the image names: a panic says where it happened.
    pub sources: Vec<String>,
}

/// The names of source files among bytes.
fn sources_in(bytes: &[u8]) -> Vec<String> {
    let texts = bytes.split(|byte| !(byte.is_ascii_graphic()));
    let texts = texts.filter_map(|text| std::str::from_utf8(text).ok());
    texts.filter(|text| text.contains(".rs")).map(str::to_owned).collect()
}

impl Elf {
    /// Reads an image.
    ///
    /// # Panics
    /// When there is no such file, or it is no ELF file.
    #[must_use]
    pub fn read(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let file = object::File::parse(&*bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mut elf =
            Self { flash: 0, ram: 0, symbols: vec![], sizes: vec![], values: vec![], sources: vec![] };
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags, sh_type, .. } = section.flags() else { continue };
            let is_kept_free = section.name().is_ok_and(|name| KEPT_FREE.contains(&name));
            if !sh_flags.contains(SHF_ALLOC) || is_kept_free {
                continue;
            }
            let at = section.address();
            let in_ram = at >= RAM && !MAPPED_FLASH.iter().any(|range| range.contains(&at));
            let stored = sh_type != SHT_NOBITS;
            elf.ram += if in_ram { section.size() } else { 0 };
            elf.flash += if stored { section.size() } else { 0 };
            if stored {
                elf.sources.extend(sources_in(section.data().unwrap_or_default()));
            }
        }
        for symbol in file.symbols() {
            let Ok(name) = symbol.name() else { continue };
            elf.symbols.push(name.to_owned());
            elf.sizes.push(symbol.size());
            elf.values.push(symbol.address());
        }
        elf
    }

    /// The symbols whose name contains one of `parts`.
    pub fn symbols_with<'a>(&'a self, parts: &'a [&str]) -> impl Iterator<Item = &'a str> {
        self.symbols.iter().map(String::as_str).filter(|name| parts.iter().any(|part| name.contains(part)))
    }

    /// The value of a symbol: of most the address.
    ///
    /// # Panics
    /// When there is no such symbol.
    #[must_use]
    pub fn value_of(&self, symbol: &str) -> u64 {
        let at = self.symbols.iter().position(|name| name == symbol);
        at.and_then(|at| self.values.get(at).copied()).unwrap_or_else(|| panic!("the image has no {symbol}"))
    }

    /// The bytes of the symbols whose names `count` accepts.
    pub fn size_of(&self, count: impl Fn(&str) -> bool) -> u64 {
        self.symbols.iter().zip(&self.sizes).filter(|(name, _)| count(name)).map(|(_, size)| size).sum()
    }
}

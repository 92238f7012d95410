//! Numbered issues: what can be wrong with a pack. Numbers are never reused and titles are part of `docs/FORMAT.md`.

use serde::{Serialize, Serializer};
use std::fmt;

/// One table feeds the variants, their numbers, their titles and the list of all.
macro_rules! issue_codes {
    ($($name:ident = $number:literal, $title:literal;)*) => {
        /// What is wrong, by number: G1xxx container, G2xxx parameters, G3xxx typed sections.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[repr(u16)]
        pub enum IssueCode {
            $(#[doc = $title] $name = $number,)*
        }

        impl IssueCode {
            /// Every code, in order of number.
            pub const ALL: &[IssueCode] = &[$(IssueCode::$name,)*];

            /// What is wrong, in a few words.
            pub fn title(self) -> &'static str {
                match self {
                    $(IssueCode::$name => $title,)*
                }
            }
        }
    };
}

issue_codes! {
    FileTooShort = 1001, "file shorter than the header";
    BadMagic = 1002, "not a glintpack";
    OverlapsHeader = 1003, "section overlaps header";
    UnsupportedMajor = 1004, "unsupported major version";
    FileLength = 1005, "file length differs from header";
    UnknownFlags = 1006, "unknown header flags";
    TableOutOfFile = 1007, "section table past end of file";
    HeaderChecksum = 1008, "header checksum differs";
    FileTooLarge = 1009, "file larger than limit";
    TooManySections = 1010, "more sections than limit";
    RawTooLarge = 1011, "decompressed size larger than limit";
    BadName = 1012, "invalid section name";
    DuplicateSection = 1013, "duplicate section";
    UnknownCodec = 1014, "unknown codec";
    BadRequiredFlag = 1015, "invalid required flag";
    UnknownResource = 1016, "unknown resource type";
    BadResource = 1017, "impossible resource descriptor";
    UnusedBytes = 1018, "unused descriptor bytes not zero";
    RawLength = 1019, "raw length differs from descriptor";
    StoredLength = 1020, "stored length differs from raw length";
    Misaligned = 1021, "section not aligned";
    SectionsOverlap = 1022, "sections overlap";
    SectionGap = 1023, "gap before section";
    SectionOutOfFile = 1024, "section past end of file";
    TrailingBytes = 1025, "bytes after last section";
    PaddingNotZero = 1026, "padding not zero";
    SectionChecksum = 1027, "section checksum differs";
    BadCompression = 1028, "compressed data damaged";
    DecompressedLength = 1029, "decompressed length differs";
    UnknownRequired = 1030, "unknown required section";
    UnknownOptional = 1031, "unknown optional section";
    UnsupportedSectionVersion = 1032, "unsupported section version";
    ParametersMalformed = 2001, "parameters do not decode";
    ParametersTrailing = 2002, "bytes after parameters";
    ParametersTooLarge = 2003, "parameters larger than limit";
    BadProvenance = 2004, "invalid provenance";
    MissingSection = 3001, "section missing from material";
    OrphanSection = 3002, "section without its parameters";
    WrongDescriptor = 3003, "wrong resource descriptor for kind";
    NdfParameters = 3004, "NDF map parameter out of range";
    NdfLevels = 3005, "NDF map levels inconsistent";
    NdfNodeCount = 3006, "node count differs from levels";
    NdfNodeOutOfAtlas = 3007, "node outside atlas";
    NdfNodeValue = 3008, "node value out of range";
    NdfNodeBorder = 3009, "texels around node not zero";
    PaletteLength = 3010, "palette length wrong";
    PaletteValue = 3011, "palette transform unusable";
    PlacementGrid = 3012, "placement grid out of range";
    NoiseDescriptor = 3013, "noise map descriptor wrong";
    NoiseClass = 3014, "noise map class outside palette";
    NoiseOwner = 3015, "noise map owner out of range";
    NoiseReserved = 3016, "noise map reserved bits not zero";
    ClassesDescriptor = 3017, "class map descriptor wrong";
    LayerName = 3018, "layer names a missing material";
    LayerValue = 3019, "layer reflectance out of range";
    DictionaryParameters = 3020, "dictionary parameter out of range";
    DictionaryShape = 3021, "dictionary buffer differs from parameters";
    DictionaryValue = 3022, "dictionary value out of range";
    DictionaryRow = 3023, "dictionary row not normalised";
    DictionaryUniform = 3024, "dictionary uniforms differ from parameters";
    DictionaryPair = 3025, "dictionary pair differs from its row";
    EnvironmentParameters = 3030, "environment parameter out of range";
    EnvironmentLevels = 3031, "environment levels do not rise from 0";
    EnvironmentShape = 3032, "environment section differs from parameters";
    EnvironmentRadiance = 3033, "environment radiance out of range";
    EnvironmentIndicators = 3034, "environment indicators are no shares of a whole";
    EnvironmentAlbedo = 3035, "environment albedo out of range";
    EnvironmentUniform = 3036, "environment uniform differs from parameters";
    AreaLightParameters = 3040, "area light parameter out of range";
    AreaLightShape = 3041, "area light resource differs from parameters";
    AreaLightNormal = 3042, "area light normal out of range";
    AreaLightRoughness = 3043, "area light roughness out of range";
    LtcShape = 3044, "LTC table of wrong format or size";
    LtcValue = 3045, "LTC table value out of range";
    AreaLightUniform = 3046, "area light uniforms differ from parameters";
    LobesParameters = 3050, "lobe parameter out of range";
    LobesLevels = 3051, "lobe levels inconsistent";
    LobesCount = 3052, "lobe count differs from levels";
    LobeValue = 3053, "lobe value out of range";
    LobeCellEmpty = 3054, "cell without lobes";
    LobesNormalsShape = 3055, "lobe normals differ from parameters";
    LobesNormal = 3056, "lobe normal out of range";
    LobesNormalPair = 3057, "lobe normal pair inconsistent";
    LobesUniform = 3058, "lobe uniform differs from parameters";
    SynthesisParameters = 3060, "synthesis parameter out of range";
    SynthesisShape = 3061, "synthesis buffer differs from parameters";
    SynthesisOffset = 3062, "synthesis patch outside sample";
    SynthesisSeam = 3063, "synthesis seam path broken";
    SurfaceMismatch = 3064, "lobes and synthesis of a surface do not fit";
    SynthesisPadding = 3065, "synthesis buffer does not end with zeros";
    NdfUniform = 3070, "NDF map uniform differs from parameters";
    LayerUniform = 3071, "layered material uniform differs from parameters";
    GlintsParameters = 3080, "counted facets parameter out of range";
    GlintsShape = 3081, "counted facets buffer differs from parameters";
    GlintsUniform = 3082, "counted facets uniforms differ from parameters";
    GlintsColours = 3083, "counted facets colours differ from parameters";
}

impl fmt::Display for IssueCode {
    /// `G1003`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "G{:04}", *self as u16)
    }
}

impl Serialize for IssueCode {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Whether a pack with an issue can be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// It cannot.
    Error,
    /// It can, without the part named.
    Warning,
}

/// One thing that is wrong with a pack.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Issue {
    /// What is wrong, by number.
    pub code: IssueCode,
    /// Whether the pack can be used all the same.
    pub severity: Severity,
    /// What was expected, what was found, what to do.
    pub message: String,
    /// Byte of the file.
    pub offset: Option<u64>,
    /// Kind and name of the section: `NMPP "rock"`.
    pub section: Option<String>,
}

impl Issue {
    pub(crate) fn error(code: IssueCode, message: impl Into<String>) -> Issue {
        Issue { code, severity: Severity::Error, message: message.into(), offset: None, section: None }
    }

    pub(crate) fn warning(code: IssueCode, message: impl Into<String>) -> Issue {
        Issue { severity: Severity::Warning, ..Issue::error(code, message) }
    }

    /// The issue at a byte of the file.
    pub(crate) fn at(self, offset: u64) -> Issue {
        Issue { offset: Some(offset), ..self }
    }

    /// The issue in a section.
    pub(crate) fn of(self, section: impl Into<String>) -> Issue {
        Issue { section: Some(section.into()), ..self }
    }
}

impl fmt::Display for Issue {
    /// `G1003 section overlaps header: expected …, found … (NMPP "rock", byte 0)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}: {}", self.code, self.code.title(), self.message)?;
        match (&self.section, self.offset) {
            (Some(section), Some(offset)) => write!(f, " ({section}, byte {offset})"),
            (Some(section), None) => write!(f, " ({section})"),
            (None, Some(offset)) => write!(f, " (byte {offset})"),
            (None, None) => Ok(()),
        }
    }
}

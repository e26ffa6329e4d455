//! Numbers of binary files.

/// The order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ByteOrder {
    Little,
    Big,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// Size in bytes.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Whether it is an integer.
    pub(crate) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The number at the start of `bytes`, where 64-bit integers are rounded; `None` if there are too few bytes.
    pub(crate) fn decode(self, order: ByteOrder, bytes: &[u8]) -> Option<f64> {
        macro_rules! decode {
            ($type:ty) => {{
                let bytes = *bytes.first_chunk()?;
                match order {
                    ByteOrder::Little => <$type>::from_le_bytes(bytes) as f64,
                    ByteOrder::Big => <$type>::from_be_bytes(bytes) as f64,
                }
            }};
        }
        Some(match self {
            Self::I8 => decode!(i8),
            Self::U8 => decode!(u8),
            Self::I16 => decode!(i16),
            Self::U16 => decode!(u16),
            Self::I32 => decode!(i32),
            Self::U32 => decode!(u32),
            Self::I64 => decode!(i64),
            Self::U64 => decode!(u64),
            Self::F32 => decode!(f32),
            Self::F64 => decode!(f64),
        })
    }
}

/// Bytes that are read one after the other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bytes<'a> {
    /// What is left.
    pub(crate) rest: &'a [u8],
    /// Where in the file that begins.
    pub(crate) at: usize,
    pub(crate) order: ByteOrder,
}

impl<'a> Bytes<'a> {
    pub(crate) fn new(bytes: &'a [u8], at: usize, order: ByteOrder) -> Self {
        Self { rest: bytes.get(at..).unwrap_or_default(), at, order }
    }

    /// The next bytes; `None`, and nothing is taken, if there are fewer.
    pub(crate) fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(length)?;
        (self.rest, self.at) = (rest, self.at + length);
        Some(taken)
    }

    pub(crate) fn number(&mut self, scalar: Scalar) -> Option<f64> {
        scalar.decode(self.order, self.take(scalar.size())?)
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.number(Scalar::U32).map(|word| word as u32)
    }
}

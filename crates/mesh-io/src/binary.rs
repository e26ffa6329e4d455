//! Numbers of binary files.

/// The order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
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
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Whether it is an integer.
    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The number at the start of `bytes`, where 64-bit integers are rounded; `None` if there are too few bytes.
    #[inline]
    pub(super) fn decode(self, order: ByteOrder, bytes: &[u8]) -> Option<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_byte_orders_decode() {
        assert_eq!(Scalar::I16.decode(ByteOrder::Little, &[0xfe, 0xff, 7]), Some(-2.0));
        assert_eq!(Scalar::U16.decode(ByteOrder::Big, &[1, 2]), Some(258.0));
        assert_eq!(Scalar::F32.decode(ByteOrder::Big, &1.5f32.to_be_bytes()), Some(1.5));
        assert_eq!(Scalar::F64.decode(ByteOrder::Little, &[0; 7]), None);
    }
}

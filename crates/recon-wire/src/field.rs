//! The field types of the ICD's tables 1 and 2, most significant byte first.
use crate::error::Error;

/// A primitive type of table 1.
pub trait Field: Copy {
    /// Its bytes on the wire.
    type Bytes: AsRef<[u8]>;
    /// How many they are.
    const SIZE: usize;
    /// The value as wire bytes.
    fn to_wire(self) -> Self::Bytes;
    /// Takes the value off the front of `reader`.
    fn read(reader: &mut Reader<'_>, name: &'static str) -> Result<Self, Error>;
    /// The bits, as an unsigned number: equal bits are equal values, NaN included.
    fn bits(self) -> u64;
}

/// uint24: 0 to 16,777,215.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct U24(u32);

/// int24, two's complement: -8,388,608 to 8,388,607.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct I24(i32);

impl U24 {
    /// The value, if it fits 24 bits.
    pub fn new(value: u32) -> Result<Self, Error> {
        if value < 1 << 24 {
            Ok(Self(value))
        } else {
            Err(out_of_range("uint24", "0 to 16777215", value.into()))
        }
    }
    /// The value.
    pub fn get(self) -> u32 {
        self.0
    }
}

impl I24 {
    /// The value, if it fits 24 bits.
    pub fn new(value: i32) -> Result<Self, Error> {
        let fits = (-(1 << 23)..1 << 23).contains(&value);
        if fits {
            Ok(Self(value))
        } else {
            Err(out_of_range("int24", "-8388608 to 8388607", value.into()))
        }
    }
    /// The value.
    pub fn get(self) -> i32 {
        self.0
    }
}

fn out_of_range(field: &'static str, expected: &str, came: i64) -> Error {
    Error::Value {
        field,
        expected: expected.to_owned(),
        came: came.to_string(),
    }
}

macro_rules! primitive {
    ($($type:ty => $bits:ty),+) => {$(
        impl Field for $type {
            type Bytes = [u8; size_of::<$type>()];
            const SIZE: usize = size_of::<$type>();
            #[inline]
            fn to_wire(self) -> Self::Bytes {
                self.to_be_bytes()
            }
            #[inline]
            fn read(reader: &mut Reader<'_>, name: &'static str) -> Result<Self, Error> {
                reader.array(name).map(Self::from_be_bytes)
            }
            #[inline]
            fn bits(self) -> u64 {
                <$bits>::from_be_bytes(self.to_be_bytes()).into()
            }
        }
    )+};
}

primitive!(u8 => u8, u16 => u16, u32 => u32, u64 => u64, i8 => u8, i16 => u16, i32 => u32, i64 => u64, f32 => u32, f64 => u64);

impl Field for U24 {
    type Bytes = [u8; 3];
    const SIZE: usize = 3;
    fn to_wire(self) -> [u8; 3] {
        let [_, high, middle, low] = self.0.to_be_bytes();
        [high, middle, low]
    }
    fn read(reader: &mut Reader<'_>, name: &'static str) -> Result<Self, Error> {
        let [high, middle, low] = reader.array(name)?;
        Ok(Self(u32::from_be_bytes([0, high, middle, low])))
    }
    fn bits(self) -> u64 {
        self.0.into()
    }
}

impl Field for I24 {
    type Bytes = [u8; 3];
    const SIZE: usize = 3;
    fn to_wire(self) -> [u8; 3] {
        let [_, high, middle, low] = self.0.to_be_bytes();
        [high, middle, low]
    }
    fn read(reader: &mut Reader<'_>, name: &'static str) -> Result<Self, Error> {
        let [high, middle, low] = reader.array(name)?;
        // Into the upper three bytes and back down: the shift carries the sign along.
        Ok(Self(i32::from_be_bytes([high, middle, low, 0]) >> 8))
    }
    fn bits(self) -> u64 {
        (self.0 as u32 & 0x00ff_ffff).into()
    }
}

/// Takes fields off the front of a payload.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// A reader at the start of `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// The next `N` bytes.
    #[inline]
    pub fn array<const N: usize>(&mut self, field: &'static str) -> Result<[u8; N], Error> {
        let came = self.rest.len();
        let (array, rest) = self.rest.split_first_chunk().ok_or(Error::Short {
            field,
            expected: N,
            came,
        })?;
        self.rest = rest;
        Ok(*array)
    }

    /// The next `len` bytes.
    pub fn bytes(&mut self, len: usize, field: &'static str) -> Result<&'a [u8], Error> {
        let came = self.rest.len();
        let (bytes, rest) = self.rest.split_at_checked(len).ok_or(Error::Short {
            field,
            expected: len,
            came,
        })?;
        self.rest = rest;
        Ok(bytes)
    }

    /// A String of table 2: a uint32 byte count, then as many bytes (UTF-8 by rule, kept raw here).
    pub fn string(&mut self, field: &'static str) -> Result<&'a [u8], Error> {
        let len = u32::read(self, field)?;
        self.bytes(usize::try_from(len).unwrap_or(usize::MAX), field)
    }

    /// Everything that is left.
    pub fn remaining(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.rest)
    }

    /// How many bytes are left.
    pub fn left(&self) -> usize {
        self.rest.len()
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }
}

/// Appends a primitive.
pub fn put<T: Field>(out: &mut Vec<u8>, value: T) {
    out.extend_from_slice(value.to_wire().as_ref());
}

/// Appends a String of table 2. Fails when its byte count does not fit a uint32.
pub fn put_string(out: &mut Vec<u8>, bytes: &[u8], field: &'static str) -> Result<(), Error> {
    let len = u32::try_from(bytes.len()).map_err(|_| Error::Value {
        field,
        expected: "at most 4294967295 bytes".to_owned(),
        came: format!("{} bytes", bytes.len()),
    })?;
    put(out, len);
    out.extend_from_slice(bytes);
    Ok(())
}

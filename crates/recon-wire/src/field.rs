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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The value as wire bytes and read back, with its bits.
    fn trip<T: Field>(value: T) -> (Vec<u8>, T, u64) {
        let mut bytes = Vec::new();
        put(&mut bytes, value);
        let mut reader = Reader::new(&bytes);
        let back = T::read(&mut reader, "value").expect("as many bytes as it takes");
        assert!(reader.is_empty());
        assert_eq!(bytes.len(), T::SIZE);
        assert_eq!(back.bits(), value.bits());
        (bytes, back, value.bits())
    }

    #[test]
    fn most_significant_byte_first() {
        assert_eq!(trip(0x12u8).0, [0x12]);
        assert_eq!(trip(0x1234u16).0, [0x12, 0x34]);
        assert_eq!(
            trip(U24::new(0x12_3456).expect("24 bits")).0,
            [0x12, 0x34, 0x56]
        );
        assert_eq!(trip(0x1234_5678u32).0, [0x12, 0x34, 0x56, 0x78]);
        assert_eq!(trip(0x0102_0304_0506_0708u64).0, [1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(trip(-2i8).0, [0xfe]);
        assert_eq!(trip(-2i16).0, [0xff, 0xfe]);
        assert_eq!(trip(I24::new(-2).expect("24 bits")).0, [0xff, 0xff, 0xfe]);
        assert_eq!(trip(-2i32).0, [0xff, 0xff, 0xff, 0xfe]);
        assert_eq!(
            trip(-2i64).0,
            [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe]
        );
        assert_eq!(trip(1.5f32).0, [0x3f, 0xc0, 0, 0]);
        assert_eq!(trip(-1.5f64).0, [0xbf, 0xf8, 0, 0, 0, 0, 0, 0]);
    }

    #[test]
    fn a_signalling_nan_keeps_its_payload() {
        assert_eq!(
            trip(f32::from_bits(0xff8a_bcde)).0,
            [0xff, 0x8a, 0xbc, 0xde]
        );
        assert_eq!(
            trip(f64::from_bits(0xfff0_0000_00c0_ffee)).2,
            0xfff0_0000_00c0_ffee
        );
    }

    #[test]
    fn what_needs_more_than_24_bits_is_refused() {
        assert_eq!(U24::new(0x00ff_ffff).map(U24::get), Ok(0x00ff_ffff));
        assert_eq!(I24::new(-0x0080_0000).map(I24::get), Ok(-0x0080_0000));
        let error = U24::new(0x0100_0000).expect_err("25 bits");
        assert_eq!(
            (error.expected(), error.came()),
            ("0 to 16777215".into(), "16777216".into())
        );
        let error = I24::new(0x0080_0000).expect_err("25 bits");
        assert_eq!(error.came(), "8388608");
        assert!(I24::new(-0x0080_0001).is_err());
    }

    #[test]
    fn a_string_counts_bytes_and_may_lie_about_them() {
        let mut bytes = Vec::new();
        put_string(&mut bytes, "鷹".as_bytes(), "text").expect("short");
        assert_eq!(bytes, [0, 0, 0, 3, 0xe9, 0xb7, 0xb9]);
        assert_eq!(Reader::new(&bytes).string("text"), Ok("鷹".as_bytes()));
        let lying = [0xff, 0xff, 0xff, 0xff, b'x'];
        let expected = Error::Short {
            field: "text",
            expected: 0xffff_ffff,
            came: 1,
        };
        assert_eq!(Reader::new(&lying).string("text"), Err(expected));
    }

    proptest! {
        #[test]
        fn every_value_of_every_type_survives(bits in any::<u64>()) {
            prop_assert_eq!(trip(bits as u8).1, bits as u8);
            prop_assert_eq!(trip(bits as u16).1, bits as u16);
            prop_assert_eq!(trip(bits as u32).1, bits as u32);
            prop_assert_eq!(trip(bits).1, bits);
            prop_assert_eq!(trip(bits as i8).1, bits as i8);
            prop_assert_eq!(trip(bits as i16).1, bits as i16);
            prop_assert_eq!(trip(bits as i32).1, bits as i32);
            prop_assert_eq!(trip(bits as i64).1, bits as i64);
            let unsigned = U24::new(bits as u32 >> 8).expect("24 bits");
            prop_assert_eq!(trip(unsigned).1, unsigned);
            let signed = I24::new(bits as i32 >> 8).expect("24 bits");
            prop_assert_eq!(trip(signed).1, signed);
            prop_assert_eq!(trip(f32::from_bits(bits as u32)).2, u64::from(bits as u32));
            prop_assert_eq!(trip(f64::from_bits(bits)).2, bits);
        }

        #[test]
        fn a_value_cut_short_is_an_error(len in 0usize..8) {
            let bytes = [0; 8];
            let expected = Error::Short { field: "value", expected: 8, came: len };
            prop_assert_eq!(f64::read(&mut Reader::new(&bytes[..len]), "value").map(f64::to_bits), Err(expected));
        }
    }
}

//! How a row of primitive fields becomes a struct.

/// Defines a struct of primitive fields in wire order, with its size, reader and writer. Equality is by bits.
macro_rules! record {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty,)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: $type,)+
        }

        impl $name {
            /// Bytes on the wire.
            pub const SIZE: usize = 0 $(+ <$type as $crate::field::Field>::SIZE)+;

            /// The fields as wire bytes.
            #[inline]
            pub fn to_wire(&self) -> [u8; Self::SIZE] {
                use $crate::field::Field;
                let mut bytes = [0; Self::SIZE];
                let mut _at = 0;
                $(
                    bytes[_at.._at + <$type>::SIZE].copy_from_slice(self.$field.to_wire().as_ref());
                    _at += <$type>::SIZE;
                )+
                bytes
            }

            /// Takes the fields off the front of `reader`.
            #[inline]
            pub fn from_wire(reader: &mut $crate::field::Reader<'_>) -> Result<Self, $crate::Error> {
                use $crate::field::Field;
                let bytes = reader.array::<{ Self::SIZE }>(stringify!($name))?;
                let mut fields = $crate::field::Reader::new(&bytes);
                Ok(Self { $($field: <$type>::read(&mut fields, stringify!($field))?,)+ })
            }
        }

        impl PartialEq for $name {
            fn eq(&self, other: &Self) -> bool {
                use $crate::field::Field;
                true $(&& self.$field.bits() == other.$field.bits())+
            }
        }

        impl Eq for $name {}

        impl std::hash::Hash for $name {
            fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
                self.to_wire().hash(state);
            }
        }
    };
    ($(#[$doc:meta])* packet $pid:literal $name:ident { $($fields:tt)+ }) => {
        record!($(#[$doc])* $name { $($fields)+ });

        impl $crate::packet::Payload for $name {
            const PID: u8 = $pid;
            const FIXED_BYTES: Option<usize> = Some(Self::SIZE);

            fn payload_bytes(&self) -> usize {
                Self::SIZE
            }

            fn check(&self, _limits: &$crate::Limits) -> Result<(), $crate::Error> {
                Ok(())
            }

            fn write(&self, out: &mut Vec<u8>) -> Result<(), $crate::Error> {
                out.extend_from_slice(&self.to_wire());
                Ok(())
            }

            #[inline]
            fn read(reader: &mut $crate::field::Reader<'_>) -> Result<Self, $crate::Error> {
                Self::from_wire(reader)
            }
        }
    };
}

pub(super) use record;

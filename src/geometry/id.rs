//! Index newtypes, so that a vertex number cannot be used where a face number is meant.

use serde::{Deserialize, Serialize};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(u32);

        impl $name {
            /// Stands for "none" in arrays of ids; not the id of anything.
            pub const NONE: Self = Self(u32::MAX);

            /// Makes an id from an array index.
            ///
            /// # Panics
            /// If `index` needs more than 32 bits: no structure of this program grows that large.
            #[must_use]
            pub fn new(index: usize) -> Self {
                Self(u32::try_from(index).expect("fewer than 2^32 elements"))
            }

            /// The array index.
            #[must_use]
            pub const fn index(self) -> usize {
                self.0 as usize
            }

            /// The number as stored.
            #[must_use]
            pub const fn raw(self) -> u32 {
                self.0
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}

id!(
    /// A mesh point.
    VertexId
);
id!(
    /// A tetrahedron of a mesh.
    TetId
);
id!(
    /// A triangle of a surface.
    FaceId
);
id!(
    /// A region of a [`Plc`](super::Plc); 0 is the air around everything.
    RegionId
);

impl RegionId {
    /// The unbounded air around the antenna.
    pub const AIR: Self = Self(0);
}

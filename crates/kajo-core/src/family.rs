//! Closed families: typed pools behind 32-bit handles.
//!
//! A family is a trait with a fixed list of members. Each member type has a pool of its own,
//! `Vec<Member>`, and a handle names a member by kind (upper bits) and index (lower bits).
//! Dispatch is a `match` on the kind: no pointers to trait objects, no virtual calls. The one macro below writes handle,
//! pools, an enum of any member by value, dispatch and the names of all members from their list; adding a member is its
//! file and one line. Methods of members that ask other members, or other pools, stand on a type that has all of these,
//! which members are handed. How a member is written in a scene is defined in `compile`.

/// How many low bits of a handle are the index: 2^27 members of each kind, 32 kinds.
pub(crate) const INDEX_BITS: u32 = 27;

/// What names no member: no pool is so long that the handle of its last member has all bits set.
pub(crate) const NO_MEMBER: u32 = u32::MAX;

/// Kind and index of a handle.
#[inline]
pub(crate) fn split(handle: u32) -> (u32, usize) {
    (handle >> INDEX_BITS, (handle & ((1 << INDEX_BITS) - 1)) as usize)
}

/// A value that has a pool in `Pools`.
pub trait Pooled<Pools> {
    /// What names a stored value.
    type Handle;

    /// Stores the value and returns its name; `None` when the pool is full.
    fn store(self, pools: &mut Pools) -> Option<Self::Handle>;

    /// The value that a handle names, if it is one of this type.
    fn find(pools: &Pools, handle: Self::Handle) -> Option<&Self>;
}

macro_rules! family {
    (
        $(#[$handle_doc:meta])* handle $Handle:ident;
        $(#[$pools_doc:meta])* pools $Pools:ident;
        $(#[$any_doc:meta])* any $Any:ident;
        contract $Contract:ident;
        members $members:tt
        any methods { $(
            $(#[$own_doc:meta])*
            fn $own_method:ident() -> $OwnOut:ty;
        )* }
        $(all methods { $(
            $(#[$all_doc:meta])*
            fn $all_method:ident ($all_arg:ident: $AllArg:ty);
        )* })?
        methods { $(
            $(#[$method_doc:meta])*
            fn $method:ident $(<$G:ident: $Bound:path>)? ($($args:tt)*) $(-> $Out:ty)?;
        )* }
        $(methods of $Context:ident.$pools:ident { $(
            $(#[$of_doc:meta])*
            fn $of_method:ident ($($of_args:tt)*) $(-> $OfOut:ty)?;
        )* })?
    ) => {
        $(#[$handle_doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub struct $Handle(u32);

        family!(@pools [$(#[$pools_doc])*] $Pools $members);
        family!(@any [$(#[$any_doc])*] $Any $Handle $Pools $members);

        const _: () = {
            family!(@kinds $Handle $Any $Pools $members);

            impl $Any {
                $(family!(@any_method [$(#[$own_doc])*] $Any $Contract $members $own_method [$OwnOut]);)*
            }

            impl $Pools {
                $($(family!(@all_method [$(#[$all_doc])*] $Contract $members $all_method $all_arg [$AllArg]);)*)?
                $(family!(@method [$(#[$method_doc])*] $Handle $Contract $members
                    $method [$($G $Bound)?] ($($args)*) [$($Out)?]);)*
            }

            $(impl $Context {
                $(family!(@method_of $pools [$(#[$of_doc])*] $Handle $Contract $members
                    $of_method ($($of_args)*) [$($OfOut)?]);)*
            })?
        };
    };

    (@pools [$(#[$doc:meta])*] $Pools:ident { $($field:ident: $Member:ident),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Default)]
        pub struct $Pools {
            $(
                #[doc = concat!("All members of type `", stringify!($Member), "`.")]
                pub $field: Vec<$Member>,
            )+
        }
    };

    (
        @any [$(#[$doc:meta])*] $Any:ident $Handle:ident $Pools:ident { $($field:ident: $Member:ident),+ $(,)? }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Debug)]
        #[allow(clippy::large_enum_variant, reason = "on its way into a pool")]
        pub enum $Any {
            $(
                #[doc = concat!("A `", stringify!($Member), "`.")]
                $Member($Member),
            )+
        }

        $(
            impl From<$Member> for $Any {
                fn from(member: $Member) -> $Any {
                    $Any::$Member(member)
                }
            }
        )+

        impl $Any {
            /// The name of the member's type.
            pub fn name(&self) -> &'static str {
                match self {
                    $($Any::$Member(_) => stringify!($Member),)+
                }
            }

            /// Stores the member and returns its name; `None` when its pool is full.
            pub fn store(self, pools: &mut $Pools) -> Option<$Handle> {
                match self {
                    $($Any::$Member(member) => crate::family::Pooled::store(member, pools),)+
                }
            }
        }
    };

    (
        @any_method [$(#[$doc:meta])*] $Any:ident $Contract:ident { $($field:ident: $Member:ident),+ $(,)? }
        $method:ident [$Out:ty]
    ) => {
        $(#[$doc])*
        pub fn $method(&self) -> $Out {
            match self {
                $($Any::$Member(member) => $Contract::$method(member),)+
            }
        }
    };

    (
        @all_method [$(#[$doc:meta])*] $Contract:ident { $($field:ident: $Member:ident),+ $(,)? }
        $method:ident $arg:ident [$Arg:ty]
    ) => {
        $(#[$doc])*
        pub fn $method(&mut self, $arg: $Arg) {
            $(self.$field.iter_mut().for_each(|member| $Contract::$method(member, $arg));)+
        }
    };

    (@kinds $Handle:ident $Any:ident $Pools:ident { $($field:ident: $Member:ident),+ $(,)? }) => {
        #[expect(non_camel_case_types, reason = "kinds are named after their pools")]
        enum Kind { $($field),+ }

        impl $Pools {
            /// The names of all kinds, those of their pools.
            pub const KINDS: &[&str] = &[$(stringify!($field)),+];

            /// The name of a member's kind.
            pub fn kind(id: $Handle) -> &'static str {
                $Pools::KINDS[crate::family::split(id.0).0 as usize]
            }

            /// A copy of the member that a handle names.
            pub fn any(&self, id: $Handle) -> $Any {
                let (kind, index) = crate::family::split(id.0);
                match kind {
                    $(k if k == Kind::$field as u32 => $Any::$Member(self.$field[index].clone()),)+
                    _ => unreachable!("handles are made by their own pools"),
                }
            }

            /// The name of a member's type.
            pub fn type_name(id: $Handle) -> &'static str {
                const TYPES: &[&str] = &[$(stringify!($Member)),+];
                TYPES[crate::family::split(id.0).0 as usize]
            }

            /// Whether a handle names a member of these pools.
            pub fn contains(&self, id: $Handle) -> bool {
                let (kind, index) = crate::family::split(id.0);
                let counts = [$(self.$field.len()),+];
                counts.get(kind as usize).is_some_and(|&count| index < count)
            }

            /// The names of all members, kind by kind.
            pub fn ids(&self) -> impl Iterator<Item = $Handle> {
                let counts = [$((Kind::$field as u32, self.$field.len() as u32)),+];
                let of_kind = |(kind, n): (u32, u32)| {
                    (0..n).map(move |index| $Handle(kind << crate::family::INDEX_BITS | index))
                };
                counts.into_iter().flat_map(of_kind)
            }

            /// Bytes of memory of all pools, room that is not used yet among them, without what members point to.
            pub fn bytes(&self) -> usize {
                0 $(+ self.$field.capacity() * size_of::<$Member>())+
            }

            /// How many members there are of each kind that has any, by the name of the pool.
            pub fn counts(&self) -> Vec<(&'static str, usize)> {
                let all = [$((stringify!($field), self.$field.len())),+];
                all.into_iter().filter(|&(_, n)| n > 0).collect()
            }
        }

        $(
            impl crate::family::Pooled<$Pools> for $Member {
                type Handle = $Handle;
                fn store(self, pools: &mut $Pools) -> Option<$Handle> {
                    let index = u32::try_from(pools.$field.len()).ok()?;
                    if index >> crate::family::INDEX_BITS != 0 {
                        return None;
                    }
                    pools.$field.push(self);
                    Some($Handle((Kind::$field as u32) << crate::family::INDEX_BITS | index))
                }

                #[inline]
                fn find(pools: &$Pools, handle: $Handle) -> Option<&$Member> {
                    let (kind, index) = crate::family::split(handle.0);
                    if kind == Kind::$field as u32 { pools.$field.get(index) } else { None }
                }
            }
        )+
    };

    (
        @method [$(#[$doc:meta])*] $Handle:ident $Contract:ident $members:tt
        $method:ident [$($G:ident $Bound:path)?] ($($arg:ident: $Arg:ty),* $(,)?) [$($Out:ty)?]
    ) => {
        $(#[$doc])*
        #[inline]
        pub fn $method $(<$G: $Bound>)? (&self, id: $Handle $(, $arg: $Arg)*) $(-> $Out)? {
            let (kind, index) = crate::family::split(id.0);
            family!(@match self kind index $Contract $method ($($arg),*) $members)
        }
    };

    (
        @method_of $pools:ident [$(#[$doc:meta])*] $Handle:ident $Contract:ident $members:tt
        $method:ident ($($arg:ident: $Arg:ty),* $(,)?) [$($Out:ty)?]
    ) => {
        $(#[$doc])*
        #[inline]
        pub fn $method(&self, id: $Handle $(, $arg: $Arg)*) $(-> $Out)? {
            let (kind, index) = crate::family::split(id.0);
            let (pools, context) = (&self.$pools, self);
            family!(@match pools kind index $Contract $method (context $(, $arg)*) $members)
        }
    };

    (
        @match $pools:ident $kind:ident $index:ident $Contract:ident $method:ident $args:tt
        { $($field:ident: $Member:ty),+ $(,)? }
    ) => {
        match $kind {
            $(k if k == Kind::$field as u32 => family!(@call $Contract $method (&$pools.$field[$index]) $args),)+
            _ => unreachable!("handles are made by their own pools"),
        }
    };

    (@call $Contract:ident $method:ident ($member:expr) ($($arg:ident),*)) => {
        $Contract::$method($member $(, $arg)*)
    };
}

pub(crate) use family;

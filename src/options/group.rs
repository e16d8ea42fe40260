//! A group of options: flags and scene file keys of the same names.

/// Options by their keys, which are their flags' names.
pub(crate) trait Keys: Sized {
    /// Returns the keys of those given.
    fn given(&self) -> Vec<String>;

    /// Returns the options whose key passes.
    #[must_use]
    fn retaining(self, passes: impl Fn(&str) -> bool) -> Self;
}

/// Declares a struct whose fields are all optional, with `over`: what it says, and for what it
/// does not say, what another says. With `derive(serde::Serialize)` it is a part of the stored
/// scene.
macro_rules! group {
    ($(#[$meta:meta])* pub struct $name:ident {
        $($(#[$field_meta:meta])* $field:ident: $type:ty,)*
    }) => {
        #[derive(Debug, Clone, PartialEq, Default, clap::Args, serde::Deserialize)]
        $(#[$meta])*
        #[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
        pub struct $name {
            $(
                $(#[$field_meta])*
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $field: Option<$type>,
            )*
        }

        impl $name {
            /// Returns these options, those not given taken from `base`.
            #[must_use]
            pub fn over(self, base: Self) -> Self {
                Self { $($field: self.$field.or(base.$field),)* }
            }
        }

        impl $crate::options::group::Keys for $name {
            fn given(&self) -> Vec<String> {
                let mut keys = Vec::new();
                $(if self.$field.is_some() {
                    keys.push(stringify!($field).replace('_', "-"));
                })*
                keys
            }

            fn retaining(self, passes: impl Fn(&str) -> bool) -> Self {
                Self {
                    $($field: self.$field.filter(|_| {
                        passes(&stringify!($field).replace('_', "-"))
                    }),)*
                }
            }
        }
    };
}
pub(crate) use group;

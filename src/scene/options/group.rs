//! A group of options: flags and scene file keys of the same names.

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
            /// The same options, those not given taken from `base`.
            #[must_use]
            pub fn over(self, base: Self) -> Self {
                Self { $($field: self.$field.or(base.$field),)* }
            }
        }
    };
}
pub(crate) use group;

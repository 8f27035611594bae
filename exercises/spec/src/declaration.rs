//! How an exercise says which functions it asks for.

/// Functions that can be called with bytes.
pub trait Dispatch: Send + Sync {
    /// Decodes the input, calls the function and encodes its output. Nothing when there is no
    /// such function or the input is not for it.
    fn dispatch(&self, function: usize, input: &[u8]) -> Option<Vec<u8>>;
}

/// Declares the functions of an exercise, once for all who need them.
///
/// It makes `Functions`, a table of functions that is called through bytes; `Answer`, which has
/// the same functions for checks and hands back a [`Fault`] when a call fails; and `FUNCTIONS`,
/// their names.
#[macro_export]
macro_rules! signatures {
    ($($(#[doc = $doc:literal])* fn $name:ident($($argument:ident: $type:ty),* $(,)?) -> $output:ty;)+) => {
        /// An answer: its functions.
        #[derive(Clone, Copy)]
        pub struct Functions {
            $($(#[doc = $doc])* pub $name: fn($($type),*) -> $output,)+
        }

        /// Names of the functions.
        pub const FUNCTIONS: &[&str] = &[$(stringify!($name)),+];

        #[allow(non_camel_case_types, clippy::upper_case_acronyms)]
        enum Number { $($name),+ }

        impl $crate::declaration::Dispatch for Functions {
            fn dispatch(&self, function: usize, input: &[u8]) -> Option<Vec<u8>> {
                $(if function == Number::$name as usize {
                    let ($($argument,)*): ($($type,)*) = postcard::from_bytes(input).ok()?;
                    return postcard::to_stdvec(&(self.$name)($($argument),*)).ok();
                })+
                None
            }
        }

        #[cfg(feature = "checks")]
        impl Functions {
            /// Functions whose outputs are spoiled: NaN, infinite, and zero or empty.
            pub fn spoiled() -> [Self; 3] {
                use $crate::answer::Spoiled;
                [
                    Self { $($name: |$(_: $type),*| <$output>::spoiled(f64::NAN)),+ },
                    Self { $($name: |$(_: $type),*| <$output>::spoiled(f64::INFINITY)),+ },
                    Self { $($name: |$(_: $type),*| <$output>::spoiled(0.0)),+ },
                ]
            }
        }

        /// The functions of an answer as checks call them.
        #[cfg(feature = "checks")]
        pub struct Answer<'a>(pub &'a dyn $crate::answer::Transport);

        #[cfg(feature = "checks")]
        impl Answer<'_> {
            $($(#[doc = $doc])*
            ///
            /// # Errors
            ///
            /// A fault when the call has no output.
            #[allow(clippy::too_many_arguments, reason = "as many as the exercise has, and the answer")]
            pub fn $name(&self, $($argument: &$type),*) -> Result<$output, $crate::answer::Fault> {
                $crate::answer::call(self.0, Number::$name as usize, &($($argument,)*))
            })+
        }
    };
}

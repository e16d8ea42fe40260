//! The types that cross between host and device, with their names in OpenCL C.

use bytemuck::Pod;

/// A plain type with the same layout on both sides.
///
/// # Safety
/// `CL_NAME` must be an OpenCL C type of the same size and layout.
pub unsafe trait Element: Pod {
    /// The type's name in OpenCL C.
    const CL_NAME: &'static str;
}

macro_rules! elements {
    ($($host:ty => $device:literal),* $(,)?) => {
        $(
            // SAFETY: the OpenCL specification, §6.1, gives these types these sizes.
            unsafe impl Element for $host {
                const CL_NAME: &'static str = $device;
            }
        )*
    };
}

elements! {
    u8 => "uchar",
    u16 => "ushort",
    i16 => "short",
    u32 => "uint",
    u64 => "ulong",
    f32 => "float",
    [f32; 2] => "float2",
    [f32; 4] => "float4",
    [u32; 2] => "uint2",
    [u32; 4] => "uint4",
}

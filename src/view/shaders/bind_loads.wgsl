// How often this invocation has read a method's data: elements of tables and looked-up texels that bind_*.wgsl fetches, a
// filtered look-up counting once. Only the viewer's overlay reads it, so that compilers drop it from other programs.

var<private> bound_loads: u32 = 0u;
// Arithmetic operations that this invocation has executed; operations.rs makes programs that add to it, in others it stays 0.
var<private> bound_operations: u32 = 0u;

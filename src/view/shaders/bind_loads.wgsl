// How often this invocation has read a method's data: elements of tables and looked-up texels that bind_*.wgsl fetches, a
// filtered look-up counting once. Only the viewer's overlay reads it, so that compilers drop it from other programs.

var<private> bound_loads: u32 = 0u;

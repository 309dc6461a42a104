#pragma once
// The viewer itself: the page but for its title and its data, as viewer/build.mjs makes it.

#include <span>

namespace hyperiso {

// HTML compressed with zlib; empty if the library was built without the viewer. It holds two markers, which
// are replaced: <!--hyperiso:title--> and, after everything else in its body, <!--hyperiso:data-->.
std::span<const unsigned char> compressed_shell();

// The extraction core as a WebAssembly module (wasm/module.cpp), as raw deflate makes it; empty if the
// library was built without it.
std::span<const unsigned char> compressed_core();

} // namespace hyperiso

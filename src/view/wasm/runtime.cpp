// What the standard library asks for and the page's worker does not have.

#include <cstdlib>

extern "C" {

// Without exceptions whatever would throw ends the module; the worker sees that as an error. The only
// exception of the extraction is std::bad_alloc.
void* __cxa_allocate_exception(unsigned long) { __builtin_trap(); }
void __cxa_throw(void*, void*, void (*)(void*)) { __builtin_trap(); }
void* __cxa_begin_catch(void*) { __builtin_trap(); }
void __cxa_end_catch() {}
void __cxa_rethrow() { __builtin_trap(); }

void abort_message(const char*, ...) { __builtin_trap(); } // and no printf for its message

} // extern "C"

// Keeps every library loaded until the program ends. What Mesa's driver holds in its globals is otherwise out
// of reach by then, and LeakSanitizer takes it for leaks of an unknown module, which cannot be told from any
// other.
extern "C" __attribute__((visibility("default"))) int dlclose(void* /*library*/) {
    return 0;
}

#include "meltscope/console/commands.hpp"

#include <cstdio>

/// Prints docs/console.md.
int main() {
    std::fputs(meltscope::console_manual().c_str(), stdout);
}

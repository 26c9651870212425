#include "machine.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace meltscope {

double physical_memory() {
    double bytes = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
    std::ifstream limit_file("/sys/fs/cgroup/memory.max"); // holds "max" where there is no limit
    double limit = 0.0;
    if (limit_file >> limit && limit > 0.0)
        bytes = std::min(bytes, limit);
    return bytes;
}

double peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * double(usage.ru_maxrss);
}

double forget_peak_memory() {
#ifdef M_TRIM_THRESHOLD
    malloc_trim(0); // what is kept of earlier work would hide what is taken anew
#endif
    std::ofstream("/proc/self/clear_refs") << 5; // see proc(5)
    double pages = 0.0, resident_pages = 0.0;
    std::ifstream("/proc/self/statm") >> pages >> resident_pages;
    return resident_pages * double(sysconf(_SC_PAGESIZE));
}

void keep_freed_memory() {
#ifdef M_MMAP_THRESHOLD
    if (std::getenv("MALLOC_MMAP_THRESHOLD_") || std::getenv("MALLOC_TRIM_THRESHOLD_"))
        return;
    mallopt(M_MMAP_THRESHOLD, 32 << 20); // the most that is allowed
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

void let_threads_sleep(char** arguments) {
    if (std::getenv("OMP_WAIT_POLICY") || std::getenv("GOMP_SPINCOUNT"))
        return;
    setenv("OMP_WAIT_POLICY", "passive", 1);
    setenv("GOMP_SPINCOUNT", "3000", 1); // some 100 us: GCC's OpenMP looks at this first
    execv("/proc/self/exe", arguments);  // comes back only if it fails; then threads spin
}

} // namespace meltscope

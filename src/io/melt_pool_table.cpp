#include "meltscope/io/melt_pool_table.hpp"

#include "meltscope/io/atomic_file.hpp"
#include "posix_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fcntl.h>
#include <limits>
#include <set>
#include <unistd.h>

namespace meltscope {

namespace {

/// The rows of an earlier part of the run that stay when it goes on at `resume_at`, header included.
std::string rows_before(const std::string& table, const std::string& header, double resume_at,
                        const std::filesystem::path& path) {
    std::string kept = header + '\n';
    std::size_t line_start = 0;
    const auto columns = std::count(header.begin(), header.end(), ',');
    for (int number = 1; line_start < table.size(); ++number) {
        const auto line_end = table.find('\n', line_start);
        if (line_end == std::string::npos)
            break; // the row that was being written when the run was cut off
        const auto line = std::string_view(table).substr(line_start, line_end - line_start);
        line_start = line_end + 1;
        if (number == 1) {
            if (line != header)
                throw TableError(
                    fmt::format("{}:1: the columns are not those of this run, which would be: {}",
                                path.string(), header));
            continue;
        }
        double time = 0.0;
        const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), time);
        if (error != std::errc{} || std::count(line.begin(), line.end(), ',') != columns)
            throw TableError(fmt::format("{}:{}: not a row of this table: \"{}\"; mend or remove it",
                                         path.string(), number, line));
        if (time < resume_at)
            kept.append(line).push_back('\n');
    }
    return kept;
}

} // namespace

std::string melt_pool_header(const std::vector<double>& isotherms) {
    if (isotherms.empty())
        throw std::invalid_argument("the melt-pool table needs an isotherm");
    std::string header = "time_s,laser_x_m,laser_y_m,power_W,speed_m_s";
    std::set<std::string> named;
    for (const double isotherm : isotherms) {
        const auto name = fmt::format("{:.7g}K", isotherm); // 1290 degC is 1563.15 K, whatever its last bit
        if (!named.insert(name).second)
            throw std::invalid_argument(fmt::format("the isotherm {} is asked for twice", name));
        const auto suffix = named.size() == 1 ? std::string() : "_" + name;
        for (const auto* figure : {"length_m", "width_m", "depth_m", "volume_m3"})
            header += fmt::format(",{}{}", figure, suffix);
    }
    return header + ",peak_K,liquid_particles,absorbed_J,lost_J";
}

MeltPoolTable::MeltPoolTable(std::filesystem::path path, std::vector<double> isotherms,
                             std::optional<double> resume_at)
    : path_(std::move(path)), isotherms_(std::move(isotherms)) {
    const auto header = melt_pool_header(isotherms_);
    std::string start = header + '\n';
    if (resume_at && std::filesystem::exists(path_)) {
        const auto table = read_file(path_);
        if (!table.empty())
            start = rows_before(table, header, *resume_at, path_);
    }
    write_file_atomically(path_, start);
    file_ = open_file(path_, O_WRONLY | O_APPEND, "cannot write").release();
}

MeltPoolTable::~MeltPoolTable() {
    if (file_ >= 0)
        ::close(file_);
}

void MeltPoolTable::append(const Snapshot& snapshot) {
    const bool fits =
        std::equal(snapshot.pools.begin(), snapshot.pools.end(), isotherms_.begin(), isotherms_.end(),
                   [](const PoolFigures& pool, double isotherm) { return pool.isotherm == isotherm; });
    if (!fits)
        throw std::invalid_argument("the snapshot's pools are not those of the table's isotherms");
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    BeamSnapshot beam;
    beam.position = {nan, nan, nan};
    if (!snapshot.beams.empty())
        beam = snapshot.beams.front();
    auto row = fmt::format("{},{},{},{},{}", snapshot.time, beam.position.x(), beam.position.y(), beam.power,
                           beam.speed);
    for (const auto& pool : snapshot.pools)
        row += fmt::format(",{},{},{},{}", pool.length, pool.width, pool.depth, pool.volume);
    row += fmt::format(",{},{},{},{}\n", snapshot.peak_temperature, snapshot.liquid_particles,
                       snapshot.absorbed_energy, snapshot.lost_energy);
    const off_t end = ::lseek(file_, 0, SEEK_END);
    if (end < 0)
        throw_file_error("cannot write", path_, errno);
    try {
        write_all(file_, row, path_);
    } catch (...) {
        // Should this fail too, half a row stays, which resuming drops.
        [[maybe_unused]] const int ignored = ::ftruncate(file_, end);
        throw;
    }
}

} // namespace meltscope

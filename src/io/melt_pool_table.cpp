#include "meltscope/io/melt_pool_table.hpp"

#include "meltscope/io/atomic_file.hpp"
#include "posix_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fcntl.h>
#include <limits>
#include <sys/stat.h>
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

RowFile::RowFile(std::filesystem::path path, const std::string& header, std::optional<double> resume_at)
    : path_(std::move(path)), header_(header) {
    std::string start = header + '\n';
    if (resume_at && std::filesystem::exists(path_)) {
        const auto table = read_file(path_);
        if (!table.empty())
            start = rows_before(table, header, *resume_at, path_);
    }
    write_file_atomically(path_, start);
    open();
}

void RowFile::open() {
    if (file_ >= 0)
        ::close(file_);
    file_ = open_file(path_, O_WRONLY | O_APPEND, "cannot write").release();
}

RowFile::~RowFile() {
    if (file_ >= 0)
        ::close(file_);
}

void RowFile::append(const std::string& lines) {
    struct stat state {};
    if (::fstat(file_, &state) == 0 && state.st_nlink == 0) {
        if (path_.has_parent_path())
            std::filesystem::create_directories(path_.parent_path());
        write_file_atomically(path_, header_ + '\n');
        open();
    }
    const off_t end = ::lseek(file_, 0, SEEK_END);
    if (end < 0)
        throw_file_error("cannot write", path_, errno);
    try {
        write_all(file_, lines, path_);
    } catch (...) {
        // Should this fail too, half a row stays, which resuming drops.
        [[maybe_unused]] const int ignored = ::ftruncate(file_, end);
        throw;
    }
}

std::string melt_pool_header(const std::vector<double>& isotherms, const std::vector<std::string>& lasers) {
    if (isotherms.empty())
        throw std::invalid_argument("the melt-pool table needs an isotherm");
    std::string pool_columns;
    std::vector<std::string> suffixes;
    for (const double isotherm : isotherms) {
        const auto name = fmt::format("_{:.7g}K", isotherm); // 1290 degC is 1563.15 K, whatever its last bit
        if (std::find(suffixes.begin(), suffixes.end(), name) != suffixes.end())
            throw std::invalid_argument(fmt::format("the isotherm {} is asked for twice", name.substr(1)));
        suffixes.push_back(name);
    }
    suffixes.front().clear();
    const auto columns_of = [&](const std::string& laser) {
        std::string columns;
        for (const auto* figure : {"laser_x_m", "laser_y_m", "power_W", "speed_m_s"})
            columns += fmt::format(",{}{}", figure, laser);
        for (const std::string& suffix : suffixes)
            for (const auto* figure : {"length_m", "width_m", "depth_m", "volume_m3"})
                columns += fmt::format(",{}{}{}", figure, suffix, laser);
        return columns;
    };
    std::string header = "time_s" + columns_of("") + ",peak_K,liquid_particles,absorbed_J,lost_J";
    for (std::size_t n = 1; n < lasers.size(); ++n)
        header += columns_of("_" + lasers[n]);
    return header;
}

MeltPoolTable::MeltPoolTable(std::filesystem::path path, std::vector<double> isotherms,
                             std::vector<std::string> lasers, std::optional<double> resume_at)
    : isotherms_(std::move(isotherms)), lasers_(std::move(lasers)),
      file_(std::move(path), melt_pool_header(isotherms_, lasers_), resume_at) {}

void MeltPoolTable::append(const Snapshot& snapshot) {
    const auto fit = [this](const std::vector<PoolFigures>& pools) {
        return std::equal(pools.begin(), pools.end(), isotherms_.begin(), isotherms_.end(),
                          [](const PoolFigures& pool, double isotherm) { return pool.isotherm == isotherm; });
    };
    if (!fit(snapshot.pools))
        throw std::invalid_argument("the snapshot's pools are not those of the table's isotherms");
    if (snapshot.beams.size() != lasers_.size())
        throw std::invalid_argument("the snapshot's beams are not those of the table's lasers");
    const auto columns_of = [](const BeamSnapshot& beam, const std::vector<PoolFigures>& pools) {
        auto columns =
            fmt::format(",{},{},{},{}", beam.position.x(), beam.position.y(), beam.power, beam.speed);
        for (const auto& pool : pools)
            columns += fmt::format(",{},{},{},{}", pool.length, pool.width, pool.depth, pool.volume);
        return columns;
    };
    BeamSnapshot none;
    none.position = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    auto row = fmt::format("{}", snapshot.time) +
               columns_of(snapshot.beams.empty() ? none : snapshot.beams.front(), snapshot.pools) +
               fmt::format(",{},{},{},{}", snapshot.peak_temperature, snapshot.liquid_particles,
                           snapshot.absorbed_energy, snapshot.lost_energy);
    for (std::size_t n = 1; n < snapshot.beams.size(); ++n) {
        if (!fit(snapshot.beams[n].pools))
            throw std::invalid_argument("a beam's pools are not those of the table's isotherms");
        row += columns_of(snapshot.beams[n], snapshot.beams[n].pools);
    }
    file_.append(row + '\n');
}

SeparatePoolsTable::SeparatePoolsTable(std::filesystem::path path, std::optional<double> resume_at)
    : file_(std::move(path),
            "time_s,isotherm_K,pool,lasers,x_m,y_m,z_m,length_m,width_m,depth_m,volume_m3,peak_K",
            resume_at) {}

void SeparatePoolsTable::append(const Snapshot& snapshot) {
    std::string rows;
    int number = 0;
    double isotherm = std::numeric_limits<double>::quiet_NaN();
    for (const SeparatePool& pool : snapshot.separate_pools) {
        const PoolFigures& figures = pool.figures;
        number = figures.isotherm == isotherm ? number + 1 : 1;
        isotherm = figures.isotherm;
        std::string lasers;
        for (const int beam : pool.beams)
            lasers += (lasers.empty() ? "" : "+") + snapshot.beams.at(beam).name;
        rows += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", snapshot.time, isotherm, number, lasers,
                            pool.center.x(), pool.center.y(), pool.center.z(), figures.length, figures.width,
                            figures.depth, figures.volume, pool.peak);
    }
    if (!rows.empty())
        file_.append(rows);
}

} // namespace meltscope

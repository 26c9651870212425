#include "run_report.hpp"

#include "html.hpp"
#include "line_plot.hpp"
#include "number_table.hpp"
#include "text.hpp"

#include "meltscope/io/run_summary.hpp"
#include "meltscope/scenario/scenario_file.hpp"
#include "viz/movie.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <regex>

namespace meltscope {
namespace {

namespace fs = std::filesystem;
using Warn = std::function<void(const std::string&)>;

constexpr const char* style = R"(
:root { --ink: #1d2430; --soft: #667085; --rule: #dfe3ea; --paper: #ffffff; --card: #f7f8fa;
        --c0: #c2410c; --c1: #1d4ed8; --c2: #15803d; --c3: #7e22ce; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e9ef; --soft: #98a2b3; --rule: #333b49; --paper: #12161d; --card: #1a202a;
          --c0: #fb923c; --c1: #7aa2ff; --c2: #4ade80; --c3: #d8b4fe; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2rem 1.5rem 4rem; max-width: 72rem; background: var(--paper); color: var(--ink);
       font: 16px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .4rem; }
h2 { font-size: 1.2rem; margin: 2.4rem 0 .8rem; padding-bottom: .3rem; border-bottom: 1px solid var(--rule); }
.lead { color: var(--soft); margin: 0; }
.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(10rem, 1fr)); gap: .8rem; margin: 1.4rem 0; }
.facts div { background: var(--card); border: 1px solid var(--rule); border-radius: 8px; padding: .6rem .9rem; }
.facts b { display: block; font-size: 1.15rem; font-variant-numeric: tabular-nums; }
.facts span { color: var(--soft); font-size: .85rem; }
video, img { display: block; margin-bottom: 1rem; width: 100%; border-radius: 8px; background: #000; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(26rem, 100%), 1fr)); gap: 1rem; }
figure { margin: 0; background: var(--card); border: 1px solid var(--rule); border-radius: 8px; padding: .8rem; }
figcaption { font-weight: 600; margin: 0 0 .4rem .2rem; }
svg { display: block; width: 100%; height: auto; }
svg text { fill: var(--soft); font-size: 13px; font-variant-numeric: tabular-nums; }
.grid { stroke: var(--rule); } .frame { stroke: var(--soft); }
.mark { stroke: var(--soft); stroke-dasharray: 5 4; }
.curve { fill: none; stroke-width: 2; stroke-linejoin: round; }
.c0 { stroke: var(--c0); } .c1 { stroke: var(--c1); } .c2 { stroke: var(--c2); } .c3 { stroke: var(--c3); }
.tables { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(26rem, 100%), 1fr)); gap: 0 2.5rem; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; padding: .3rem .4rem; border-bottom: 1px solid var(--rule); }
th { color: var(--soft); font-weight: 500; font-size: .85rem; }
.n { text-align: right; font-variant-numeric: tabular-nums; }
pre { background: var(--card); border: 1px solid var(--rule); border-radius: 8px; padding: 1rem; margin: 0;
      overflow-x: auto; font: 13px/1.45 ui-monospace, "DejaVu Sans Mono", monospace; }
a { color: var(--c1); }
)";

/// The bytes of a file; nothing if it is not there, and a warning if it cannot be read.
std::optional<std::string> read_if_there(const fs::path& path, const Warn& warn) {
    if (!fs::exists(path))
        return std::nullopt;
    std::ifstream file(path, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (file.bad() || !file.is_open()) {
        warn(fmt::format("{} cannot be read and is left out", path.string()));
        return std::nullopt;
    }
    return bytes;
}

std::optional<RunSummary> summary_of(const RunPaths& paths, const Warn& warn) {
    if (!fs::exists(paths.summary()))
        return std::nullopt;
    try {
        return read_run_summary(paths.summary());
    } catch (const std::exception& error) {
        warn(error.what());
        return std::nullopt;
    }
}

std::optional<Scenario> scenario_of(const std::string& text, const RunPaths& paths, const Warn& warn) {
    try {
        return read_scenario_text(text, {}, paths.scenario().string());
    } catch (const std::exception& error) {
        warn(error.what());
        return std::nullopt;
    }
}

std::string words_of(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

double figure(const RunSummary::Figures& figures, std::string_view name) {
    for (const auto& [key, value] : figures)
        if (key == name)
            return value;
    return std::numeric_limits<double>::quiet_NaN();
}

std::string section(const char* title, const std::string& content) {
    return content.empty() ? "" : fmt::format("<section>\n<h2>{}</h2>\n{}\n</section>\n", title, content);
}

std::string heading(const std::optional<RunSummary>& summary, const std::string& title) {
    std::string html = fmt::format("<h1>{}</h1>\n", escape_html(title));
    if (!summary)
        return html;
    std::string lead = fmt::format("meltscope {} ({})", summary->version, summary->git_hash);
    if (!summary->message.empty())
        lead += ": " + summary->message;
    html += fmt::format("<p class=\"lead\">{}</p>\n<div class=\"facts\">\n", escape_html(lead));
    const auto fact = [&](const char* name, const std::string& value) {
        html += fmt::format("<div><b>{}</b><span>{}</span></div>\n", escape_html(value), name);
    };
    fact("outcome", summary->outcome);
    fact("simulated time", in_si(summary->time, "s"));
    fact("steps", fmt::format("{}", summary->steps));
    fact("particles", fmt::format("{}", summary->particles));
    fact("wall time, h:mm:ss", clock_time(figure(summary->wall_seconds, "total")));
    fact(summary->threads == 1 ? "particle-steps/s, 1 thread"
                               : fmt::format("particle-steps/s, {} threads", summary->threads).c_str(),
         in_si(summary->particle_steps_per_second, ""));
    return html + "</div>\n";
}

/// A view's pictures in order of their numbers.
std::vector<fs::path> pictures_of(const RunPaths& paths, const std::string& view) {
    std::vector<fs::path> pictures;
    std::error_code not_there;
    for (const auto& entry : fs::directory_iterator(paths.frames(), not_there)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(view + "_") && name.ends_with(".png"))
            pictures.push_back(entry.path());
    }
    std::sort(pictures.begin(), pictures.end());
    return pictures;
}

/// A picture from the middle of a view's row, as a data URL; empty if it has none.
std::string middle_picture(const RunPaths& paths, const std::string& view, const Warn& warn) {
    const auto pictures = pictures_of(paths, view);
    if (pictures.empty())
        return {};
    const auto picture = read_if_there(pictures[pictures.size() / 2], warn);
    return picture ? data_url("image/png", *picture) : "";
}

/// The movies of all views, the overview's first; without any a picture; else nothing.
std::string moving_pictures(const RunPaths& paths, const Warn& warn) {
    std::string html;
    const std::vector<std::string>& views = viz::view_names(); // the overview is the first
    for (const std::string& view : views) {
        const auto movie = read_if_there(paths.movie(view), warn);
        if (!movie)
            continue;
        const std::string poster = middle_picture(paths, view, warn);
        html += fmt::format(
            "<video controls loop muted playsinline aria-label=\"{}\"{} src=\"{}\"></video>\n", view,
            poster.empty() ? "" : fmt::format(" poster=\"{}\"", poster), data_url("video/mp4", *movie));
    }
    for (const std::string& view : views)
        if (const std::string picture = html.empty() ? middle_picture(paths, view, warn) : "";
            !picture.empty())
            html = fmt::format("<img alt=\"{}\" src=\"{}\">\n", view, picture);
    return html;
}

/// Rate of change by central differences, at the ends by one-sided ones.
std::vector<double> rate_of_change(const std::vector<double>& x, const std::vector<double>& values) {
    std::vector<double> rate(values.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t n = 0; n < values.size() && values.size() > 1; ++n) {
        const std::size_t before = n == 0 ? 0 : n - 1, after = std::min(n + 1, values.size() - 1);
        if (x[after] > x[before])
            rate[n] = (values[after] - values[before]) / (x[after] - x[before]);
    }
    return rate;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
    for (double& value : values)
        value *= factor;
    return values;
}

/// Makes the plots of one table, with the abscissa in a unit that suits how long the run lasts.
class PoolPlots {
  public:
    PoolPlots(const NumberTable& table, const std::optional<Scenario>& scenario)
        : table_(table), scenario_(scenario), seconds_(*table.find("time_s")) {
        const double last = seconds_.empty() ? 0.0 : seconds_.back();
        const bool milli = last >= 1e-3;
        blank_.x = scaled(seconds_, milli ? 1e3 : 1e6);
        blank_.x_label = milli ? "time (ms)" : "time (µs)";
    }

    /// A column, and those of further isotherms and lasers, times a factor.
    std::string of_column(const char* title, const std::string& column, const char* unit, double factor,
                          bool of_isotherms) const {
        LinePlot plot = blank_;
        plot.title = title;
        plot.y_label = unit;
        for (std::size_t n = 0; n < table_.names.size(); ++n)
            if (table_.names[n] == column || table_.names[n].starts_with(column + "_"))
                plot.curves.push_back({name_of(table_.names[n].substr(column.size()), of_isotherms),
                                       scaled(table_.columns[n], factor)});
        return figure_of(plot);
    }

    std::string of_peak() const {
        LinePlot plot = blank_;
        plot.title = "Peak temperature";
        plot.y_label = "K";
        plot.from_zero = false;
        if (const auto* peak = table_.find("peak_K"))
            plot.curves.push_back({"peak", *peak});
        if (scenario_ && !scenario_->materials.empty()) {
            const Material& material = scenario_->materials.front();
            plot.marks.push_back({"liquidus", material.liquidus});
            if (material.boiling_point)
                plot.marks.push_back({"boiling point", *material.boiling_point});
        }
        return figure_of(plot);
    }

    std::string of_peak_rate() const {
        LinePlot plot = blank_;
        plot.title = "Heating (+) and cooling (−) of the peak";
        plot.y_label = "dT/dt (K/µs)";
        if (const auto* peak = table_.find("peak_K"))
            plot.curves.push_back({"rate", scaled(rate_of_change(seconds_, *peak), 1e-6)});
        return figure_of(plot);
    }

    std::string of_energy() const {
        LinePlot plot = blank_;
        plot.title = "Energy absorbed and lost";
        plot.y_label = "mJ";
        for (const auto& [column, name] : {std::pair{"absorbed_J", "absorbed"}, {"lost_J", "lost"}})
            if (const auto* energy = table_.find(column))
                plot.curves.push_back({name, scaled(*energy, 1e3)});
        return figure_of(plot);
    }

  private:
    /// What a column's suffix (`_1563K_right`) stands for; the first isotherm and the first laser have none.
    std::string name_of(const std::string& suffix, bool of_isotherms) const {
        static const std::regex form("(?:_([0-9.e+]+)K)?(?:_(.+))?");
        std::smatch parts;
        std::string isotherm = "first isotherm", laser;
        if (scenario_ && !scenario_->output.isotherms.empty())
            isotherm = fmt::format("{:.7g} K", scenario_->output.isotherms.front());
        if (scenario_ && scenario_->lasers.size() > 1)
            laser = scenario_->lasers.front().name;
        if (std::regex_match(suffix, parts, form)) {
            if (parts[1].matched)
                isotherm = parts[1].str() + " K";
            if (parts[2].matched)
                laser = parts[2].str();
        }
        if (!of_isotherms)
            return laser.empty() ? "power" : laser;
        return laser.empty() ? isotherm : fmt::format("{}, {}", laser, isotherm);
    }

    static std::string figure_of(const LinePlot& plot) {
        if (plot.curves.empty())
            return {};
        return fmt::format("<figure><figcaption>{}</figcaption>{}</figure>\n", escape_html(plot.title),
                           to_svg(plot));
    }

    const NumberTable& table_;
    const std::optional<Scenario>& scenario_;
    const std::vector<double>& seconds_;
    LinePlot blank_;
};

std::string pool_over_time(const RunPaths& paths, const std::optional<Scenario>& scenario, const Warn& warn) {
    const auto text = read_if_there(paths.melt_pool_table(), warn);
    if (!text)
        return {};
    const NumberTable table = parse_number_table(*text);
    if (!table.find("time_s")) {
        warn(fmt::format("{} has no column time_s and is left out", paths.melt_pool_table().string()));
        return {};
    }
    const PoolPlots plots(table, scenario);
    std::string html = "<div class=\"plots\">\n";
    html += plots.of_column("Pool length", "length_m", "µm", 1e6, true);
    html += plots.of_column("Pool width", "width_m", "µm", 1e6, true);
    html += plots.of_column("Pool depth", "depth_m", "µm", 1e6, true);
    html += plots.of_column("Pool volume", "volume_m3", "1000 µm³", 1e15, true);
    html += plots.of_peak();
    html += plots.of_peak_rate();
    html += plots.of_column("Laser power", "power_W", "W", 1.0, false);
    html += plots.of_energy();
    html += fmt::format("</div>\n<p><a download=\"melt_pool.csv\" href=\"{}\">The figures as a table "
                        "(melt_pool.csv)</a></p>",
                        data_url("text/csv", *text));
    return html;
}

std::string ledger_table(const RunSummary& summary) {
    if (summary.ledger.empty())
        return {};
    const double emitted = figure(summary.ledger, "emitted");
    std::string html = "<table>\n<tr><th>energy</th><th class=\"n\">J</th><th class=\"n\">of what was "
                       "emitted</th></tr>\n";
    for (const auto& [name, value] : summary.ledger) {
        const bool is_energy = name != "relative_residual";
        const bool is_flow = is_energy && !name.starts_with("stored");
        const std::string share =
            is_flow && emitted > 0.0 ? fmt::format("{:.2f} %", 100.0 * value / emitted) : "";
        html += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
                            escape_html(words_of(name)),
                            is_energy ? fmt::format("{:.6g}", value) : fmt::format("{:.1e}", value), share);
    }
    html += fmt::format("<tr><td>change of what is stored</td><td class=\"n\">{:.6g}</td><td></td></tr>\n",
                        figure(summary.ledger, "stored") - figure(summary.ledger, "stored_at_start"));
    return html + "</table>";
}

std::string figures_table(const char* head, const char* unit, const RunSummary::Figures& figures) {
    if (figures.empty())
        return {};
    std::string html = fmt::format("<table>\n<tr><th>{}</th><th class=\"n\">{}</th></tr>\n", head, unit);
    for (const auto& [name, value] : figures)
        html += fmt::format("<tr><td>{}</td><td class=\"n\">{:.4g}</td></tr>\n", escape_html(words_of(name)),
                            value);
    return html + "</table>";
}

std::string preformatted(const std::optional<std::string>& text) {
    return text && !text->empty() ? "<pre>" + escape_html(*text) + "</pre>" : "";
}

} // namespace

std::string report_page(const RunPaths& paths, const Warn& warn) {
    const auto summary = summary_of(paths, warn);
    const auto scenario_text = read_if_there(paths.scenario(), warn);
    const auto scenario = scenario_text ? scenario_of(*scenario_text, paths, warn) : std::nullopt;
    std::string title = summary ? summary->title : scenario ? scenario->title : "";
    if (title.empty())
        title = fs::absolute(paths.root).lexically_normal().filename().string();

    std::string page = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                       "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
    page += fmt::format("<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n", escape_html(title), style);
    page += heading(summary, title);
    page += moving_pictures(paths, warn);
    page += section("Melt pool over time", pool_over_time(paths, scenario, warn));
    if (summary) {
        page += section("Energy ledger", ledger_table(*summary));
        const std::string seconds = figures_table("phase", "s", summary->wall_seconds);
        const std::string pictures = figures_table("pictures and files", "", summary->rendering);
        page +=
            section("Wall time", seconds.empty() && pictures.empty()
                                     ? ""
                                     : fmt::format("<div class=\"tables\"><div>{}</div><div>{}</div></div>",
                                                   seconds, pictures));
    }
    page += section("Steering journal", preformatted(read_if_there(paths.journal(), warn)));
    page += section("Parameters", preformatted(scenario_text));
    return page + "</body>\n</html>\n";
}

} // namespace meltscope

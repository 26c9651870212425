#include "viz/frame_renderer.hpp"

#include "viz/annotations.hpp"
#include "viz/display.hpp"
#include "viz/panel.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <set>
#include <system_error>

#include <vtkErrorCode.h>
#include <vtkNew.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkPNGReader.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkRenderWindow.h>
#include <vtkStringArray.h>
#include <vtkWindowToImageFilter.h>

#include <fmt/format.h>

namespace meltscope::viz {

namespace {

constexpr int dots_per_inch = 72; // a font of n points is n pixels high
constexpr int png_compression = 2;
constexpr const char* time_key = "time_s";

using View = std::vector<std::unique_ptr<Panel>>;

View make_view(const std::string& name) {
    View view;
    if (name == "overview") {
        view.push_back(make_overview_panel());
    } else if (name == "section") {
        view.push_back(make_section_panel());
    } else if (name == "top") {
        view.push_back(make_top_panel());
    } else if (name == "pool") {
        view.push_back(make_pool_panel());
    } else if (name == "dashboard") {
        view.push_back(make_overview_panel());
        view.push_back(make_top_panel());
        view.push_back(make_section_panel());
        view.push_back(make_charts_panel());
    } else {
        throw VizError(fmt::format("there is no view '{}'", name));
    }
    return view;
}

/// Areas of the panels of a view, in the order of make_view, and of what surrounds them.
struct Layout {
    Rect caption;
    Rect color_bar;
    std::vector<Rect> panels;
    std::vector<std::pair<Rect, const char*>> headings; ///< above panels, where there are several
};

/// Pixels; zero where a view has one panel.
double heading_height(const std::string& view, double font) {
    return view == "dashboard" ? 1.5 * font : 0.0;
}

Layout lay_out(const std::string& view, const std::array<int, 2>& size, double font) {
    const double width = size[0];
    const double height = size[1];
    const double margin = font;
    const double caption_height = 3.6 * font;
    const double bar_width = 7.6 * font;
    Layout layout;
    layout.caption = {margin, height - 0.5 * margin - caption_height, width - 2.0 * margin, caption_height};
    layout.color_bar = {width - bar_width - margin, 2.0 * margin, bar_width,
                        height - caption_height - 4.0 * margin};
    const Rect body{margin, margin, width - bar_width - 3.5 * margin, height - caption_height - 2.5 * margin};
    if (view != "dashboard") {
        layout.panels = {body};
        return layout;
    }
    const double charts = 0.32 * body.height;
    const double right = 0.45 * body.width;
    const double upper = body.y + charts + margin;
    const double upper_height = body.height - charts - margin;
    const double column = body.x + body.width - right;
    const double top_height = 0.53 * upper_height;
    layout.panels = {{body.x, upper, body.width - right - margin, upper_height},
                     {column, upper + upper_height - top_height, right, top_height},
                     {column, upper, right, upper_height - top_height - margin},
                     {body.x, body.y, body.width, charts}}; // has headings of its own
    constexpr std::array<const char*, 3> words{"overview", "from above", "cut along the track"};
    const double heading = heading_height(view, font);
    for (std::size_t i = 0; i < words.size(); ++i) {
        Rect& panel = layout.panels[i];
        panel.height -= heading;
        layout.headings.push_back({{panel.x, panel.y + panel.height, panel.width, heading}, words[i]});
    }
    return layout;
}

const std::vector<double>& node_values(const Snapshot& snapshot, const std::string& field) {
    if (field == "phi") {
        return *snapshot.phi;
    }
    if (field == "phi_hat") {
        return *snapshot.phi_hat;
    }
    return field == "mass" ? *snapshot.mass : *snapshot.temperature;
}

/// For temperature from the coldest node to a fifth above liquidus, rounded; else all there is.
std::array<double, 2> choose_range(const Snapshot& snapshot, const std::string& field) {
    const std::vector<double>& values = node_values(snapshot, field);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    if (field == "temperature") {
        const double bottom = 50.0 * std::floor(*low / 50.0 + 1e-9); // K
        return {bottom, std::max(100.0 * std::ceil(1.2 * snapshot.liquidus / 100.0), bottom + 100.0)};
    }
    return {*low, *high > *low ? *high : *low + 1.0};
}

} // namespace

struct FrameRenderer::Impl {
    explicit Impl(Backend wanted) : display(std::make_unique<Display>(wanted)) {
        window = vtkSmartPointer<vtkRenderWindow>::New();
        if (display->x_display() != nullptr) {
            window->SetDisplayId(display->x_display());
        }
        window->SetOffScreenRendering(1);
        window->SetMultiSamples(0); // panels smooth their edges themselves
        window->SetDPI(dots_per_inch);
        window->SetNumberOfLayers(3);
        background->SetLayer(0);
        background->InteractiveOff();
        canvas.renderer()->SetLayer(2);
        window->AddRenderer(background);
        window->AddRenderer(canvas.renderer());
    }

    ~Impl() {
        if (display->lost()) {
            // Nothing that lives on a dead X connection can be taken down safely; it ends with the process.
            window->Register(nullptr);
            static_cast<void>(views.release());
        }
    }

    std::set<std::string> drawn; ///< views that have been drawn before

    View& view(const std::string& name) {
        const auto found = views->find(name);
        if (found != views->end()) {
            return found->second;
        }
        View& made = views->emplace(name, make_view(name)).first->second;
        for (const auto& panel : made) {
            window->AddRenderer(panel->renderer());
        }
        return made;
    }

    std::unique_ptr<Display> display; // outlives the window
    vtkSmartPointer<vtkRenderWindow> window;
    vtkNew<vtkRenderer> background;
    Canvas canvas;
    std::unique_ptr<std::map<std::string, View>> views = std::make_unique<std::map<std::string, View>>();
    std::map<std::string, std::array<double, 2>> ranges; // by field, chosen once
    std::string renderer_name;
};

FrameRenderer::FrameRenderer(Backend backend) : impl_(std::make_unique<Impl>(backend)) {}

FrameRenderer::~FrameRenderer() = default;

Backend FrameRenderer::backend() const {
    return impl_->display->backend();
}

std::string FrameRenderer::window_class() const {
    return impl_->window->GetClassName();
}

std::string FrameRenderer::renderer_name() const {
    return impl_->renderer_name;
}

vtkSmartPointer<vtkImageData> FrameRenderer::render(const Instant& instant,
                                                    const std::vector<HistoryPoint>& history,
                                                    const RenderOptions& options,
                                                    const std::string& view_name) {
    Impl& impl = *impl_;
    // Charts settle their margins while they are drawn: the first picture of a view is made twice.
    if (impl.drawn.insert(view_name).second) {
        render(instant, history, options, view_name);
    }
    const Snapshot& snapshot = *instant.snapshot;
    const Theme& colors = theme(options.background);

    Picture picture;
    picture.instant = &instant;
    picture.history = &history;
    picture.field = options.field;
    picture.values = &node_values(snapshot, options.field);
    picture.theme = &colors;
    picture.size = options.size;
    picture.font = std::max(9.0, 0.0255 * std::min<double>(options.size[1], 0.625 * options.size[0]));
    picture.line = picture.font / 10.0;
    picture.heading = heading_height(view_name, picture.font);
    if (options.color_range) {
        picture.range = *options.color_range;
    } else {
        picture.range =
            impl.ranges.try_emplace(options.field, choose_range(snapshot, options.field)).first->second;
    }
    picture.colors = make_lookup_table(options.colormap, picture.range);
    const auto colored = [&](vtkPolyData* part) {
        auto copy = vtkSmartPointer<vtkPolyData>::New();
        copy->ShallowCopy(part);
        copy->GetPointData()->SetScalars(
            sample_onto(part, snapshot.nodes, *picture.values, options.field.c_str()));
        return copy;
    };
    picture.surface =
        options.field == "temperature" ? instant.free_surface : colored(instant.geometry->free_surface);
    picture.walls = colored(instant.geometry->walls);

    View& shown = impl.view(view_name);
    for (auto& [name, view] : *impl.views) {
        for (const auto& panel : view) {
            panel->renderer()->SetDraw(&view == &shown);
        }
    }
    impl.window->SetSize(options.size[0], options.size[1]);
    impl.background->SetBackground(colors.background.data());
    impl.canvas.clear();
    const Layout layout = lay_out(view_name, options.size, picture.font);
    for (std::size_t i = 0; i < shown.size(); ++i) {
        shown[i]->update(picture, layout.panels[i], impl.canvas);
    }
    for (const auto& [area, words] : layout.headings) {
        draw_heading(impl.canvas, picture, area, words);
    }
    draw_caption(impl.canvas, picture, layout.caption);
    draw_color_bar(impl.canvas, picture, layout.color_bar);

    impl.window->Render();
    vtkNew<vtkWindowToImageFilter> grab;
    grab->SetInput(impl.window);
    grab->SetInputBufferTypeToRGB();
    grab->ReadFrontBufferOff();
    grab->ShouldRerenderOff();
    grab->Update();
    if (impl.display->lost()) {
        throw VizError("the X server that the pictures were made on is gone");
    }
    if (impl.renderer_name.empty()) {
        // "OpenGL renderer string:  llvmpipe (...)" in the window's report.
        const std::string report = impl.window->ReportCapabilities();
        const std::string label = "OpenGL renderer string:";
        if (const auto at = report.find(label); at != std::string::npos) {
            const auto begin = report.find_first_not_of(' ', at + label.size());
            impl.renderer_name = report.substr(begin, report.find('\n', begin) - begin);
        }
    }
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->ShallowCopy(grab->GetOutput());
    return image;
}

void write_png(vtkImageData* image, const std::filesystem::path& path, double time) {
    const std::string temporary = path.string() + ".part";
    vtkNew<vtkPNGWriter> writer;
    writer->SetFileName(temporary.c_str());
    writer->SetCompressionLevel(png_compression);
    writer->AddText(time_key, fmt::format("{}", time).c_str());
    writer->SetInputData(image);
    errno = 0;
    writer->Write();
    int reason = errno;
    if (writer->GetErrorCode() == vtkErrorCode::NoError) {
        if (std::rename(temporary.c_str(), path.c_str()) == 0) {
            return;
        }
        reason = errno;
    }
    std::error_code error;
    std::filesystem::remove(temporary, error);
    throw VizError(fmt::format("cannot write {}: {}", path.string(),
                               reason != 0 ? std::strerror(reason) : "VTK's PNG writer failed"));
}

std::optional<double> png_time(const std::filesystem::path& path) {
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(path.c_str());
    reader->UpdateInformation();
    int range[2] = {0, 0};
    reader->GetTextChunks(time_key, range);
    if (range[0] >= range[1]) {
        return std::nullopt;
    }
    const char* text = reader->GetTextValue(range[0]);
    double time = 0.0;
    if (text == nullptr || std::from_chars(text, text + std::strlen(text), time).ec != std::errc()) {
        return std::nullopt;
    }
    return time;
}

} // namespace meltscope::viz

#include "scratch.hpp"
#include "synthetic.hpp"
#include "viz/colors.hpp"
#include "viz/frame_renderer.hpp"
#include "viz/movie.hpp"
#include "viz/process.hpp"

#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <optional>
#include <set>

#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>

namespace meltscope::viz {
namespace {

/// Mean absolute difference of two pictures of one size, 0 to 255.
double difference(vtkImageData* a, vtkImageData* b) {
    auto* left = vtkUnsignedCharArray::SafeDownCast(a->GetPointData()->GetScalars());
    auto* right = vtkUnsignedCharArray::SafeDownCast(b->GetPointData()->GetScalars());
    const vtkIdType count = left->GetNumberOfValues();
    if (count != right->GetNumberOfValues()) {
        return 255.0;
    }
    double sum = 0.0;
    for (vtkIdType i = 0; i < count; ++i) {
        sum += std::abs(static_cast<int>(left->GetValue(i)) - static_cast<int>(right->GetValue(i)));
    }
    return sum / static_cast<double>(count);
}

/// How different two pictures of one size look: root mean square, over blocks of 8 x 8 pixels, of the
/// difference of their mean colours, 0 to 255. Edges that another renderer smooths otherwise weigh little,
/// whatever a reader would notice weighs much.
double visible_difference(vtkImageData* a, vtkImageData* b) {
    constexpr int block = 8;
    auto* left = vtkUnsignedCharArray::SafeDownCast(a->GetPointData()->GetScalars());
    auto* right = vtkUnsignedCharArray::SafeDownCast(b->GetPointData()->GetScalars());
    if (left->GetNumberOfValues() != right->GetNumberOfValues()) {
        return 255.0;
    }
    const int width = a->GetDimensions()[0];
    const int height = a->GetDimensions()[1];
    double squares = 0.0;
    int count = 0;
    for (int y = 0; y + block <= height; y += block) {
        for (int x = 0; x + block <= width; x += block) {
            for (int channel = 0; channel < 3; ++channel, ++count) {
                double sum = 0.0;
                for (int v = y; v < y + block; ++v) {
                    for (int u = x; u < x + block; ++u) {
                        const vtkIdType at = 3 * (static_cast<vtkIdType>(v) * width + u) + channel;
                        sum += static_cast<int>(left->GetValue(at)) - static_cast<int>(right->GetValue(at));
                    }
                }
                squares += sum * sum / (block * block * block * block);
            }
        }
    }
    return std::sqrt(squares / count);
}

vtkSmartPointer<vtkImageData> read_png(const std::filesystem::path& path) {
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    return reader->GetOutput();
}

/// A picture of that size in one colour.
vtkSmartPointer<vtkImageData> plain(vtkImageData* like, const std::array<int, 3>& color) {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->DeepCopy(like);
    auto* bytes = vtkUnsignedCharArray::SafeDownCast(image->GetPointData()->GetScalars());
    for (vtkIdType i = 0; i < bytes->GetNumberOfValues(); ++i) {
        bytes->SetValue(i, static_cast<unsigned char>(color[static_cast<std::size_t>(i % 3)]));
    }
    return image;
}

std::size_t color_count(vtkImageData* image) {
    auto* bytes = vtkUnsignedCharArray::SafeDownCast(image->GetPointData()->GetScalars());
    std::set<std::array<unsigned char, 3>> colors;
    for (vtkIdType i = 0; i < bytes->GetNumberOfTuples(); ++i) {
        colors.insert({bytes->GetValue(3 * i), bytes->GetValue(3 * i + 1), bytes->GetValue(3 * i + 2)});
    }
    return colors.size();
}

/// One window for all tests, as a run has one.
class Pictures : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        try {
            renderer = std::make_unique<FrameRenderer>(Backend::automatic);
        } catch (const VizError&) {
            renderer = nullptr;
        }
    }
    static void TearDownTestSuite() { renderer.reset(); }

    void SetUp() override {
        if (!renderer) {
            GTEST_SKIP() << "no display and no Xvfb";
        }
        plate.count = {121, 41, 19};
        plate.spacing = 15e-6;
        options.size = {640, 360};
    }

    vtkSmartPointer<vtkImageData> picture(const std::string& view, double time) {
        std::shared_ptr<const Geometry> geometry;
        std::vector<HistoryPoint> history;
        for (int i = 0; i <= 10; ++i) {
            test::SyntheticPlate small;
            small.count = {3, 3, 7};
            small.with_particles = false;
            history.push_back(history_point(*test::make_snapshot(small, 0.1 * i * time)));
        }
        const Instant instant = make_instant(test::make_snapshot(plate, time), geometry);
        return renderer->render(instant, history, options, view);
    }

    static std::unique_ptr<FrameRenderer> renderer;
    test::SyntheticPlate plate;
    RenderOptions options;
};
std::unique_ptr<FrameRenderer> Pictures::renderer;

TEST_F(Pictures, every_view_shows_more_than_a_blank) {
    for (const std::string& view : view_names()) {
        const auto image = picture(view, 600e-6);
        EXPECT_EQ(image->GetDimensions()[0], 640) << view;
        EXPECT_EQ(image->GetDimensions()[1], 360) << view;
        EXPECT_GT(color_count(image), 500U) << view;
    }
}

TEST_F(Pictures, same_instant_gives_same_picture_and_wrong_range_does_not) {
    for (const std::string& view : view_names()) {
        options.color_range = {{300.0, 2000.0}};
        const auto reference = picture(view, 600e-6);
        EXPECT_LT(difference(reference, picture(view, 600e-6)), 0.01) << view;
        options.color_range = {{300.0, 900.0}};
        EXPECT_GT(difference(reference, picture(view, 600e-6)), 0.5) << view;
        options.color_range = {{300.0, 2000.0}};
        // The section follows the laser: little but the clock differs.
        EXPECT_GT(difference(reference, picture(view, 900e-6)), 0.02) << view << " at another time";
    }
}

// The baselines in tests/unit/viz/baselines were looked at by a person. To make them anew after a wanted
// change, run this test with MELTSCOPE_BASELINES=FOLDER and look at what it puts there.
TEST_F(Pictures, views_look_like_their_baselines_and_spoilt_ones_do_not) {
    // Views remember what they have shown: how large the pool was, how wide the numbers of a chart.
    renderer = std::make_unique<FrameRenderer>(Backend::automatic);
    constexpr double same = 3.0; // of 255; the spoilt ones differ by at least twice as much
    options.size = {480, 270};
    for (const Background background : {Background::dark, Background::light}) {
        options.background = background;
        for (const std::string& view : view_names()) {
            const std::string name = view + (background == Background::light ? "_light.png" : "_dark.png");
            SCOPED_TRACE(name);
            options.color_range = {{300.0, 2000.0}};
            const auto image = picture(view, 600e-6);
            if (const char* folder = std::getenv("MELTSCOPE_BASELINES")) {
                write_png(image, std::filesystem::path(folder) / name, 600e-6);
            }
            const auto kept = std::filesystem::path(MELTSCOPE_BASELINE_FOLDER) / name;
            if (!std::filesystem::exists(kept)) {
                ADD_FAILURE() << "there is no baseline " << kept;
                continue;
            }
            const auto baseline = read_png(kept);
            EXPECT_LT(visible_difference(image, baseline), same);

            const auto& back = theme(background).background;
            std::array<int, 3> blank{};
            for (std::size_t i = 0; i < 3; ++i) {
                blank[i] = static_cast<int>(std::lround(255.0 * back[i]));
            }
            EXPECT_GT(visible_difference(plain(image, blank), baseline), 2.0 * same) << "blank";
            EXPECT_GT(visible_difference(plain(image, {120, 60, 60}), baseline), 2.0 * same) << "one colour";
            options.color_range = {{300.0, 1000.0}};
            EXPECT_GT(visible_difference(picture(view, 600e-6), baseline), 2.0 * same) << "wrong range";
        }
    }
}

TEST_F(Pictures, range_is_chosen_once_and_kept) {
    FrameRenderer fresh(Backend::automatic);
    std::shared_ptr<const Geometry> geometry;
    const Instant cold = make_instant(test::make_snapshot(plate, 0.0), geometry);
    plate.ambient = 800.0;
    const Instant hot = make_instant(test::make_snapshot(plate, 600e-6), geometry);
    fresh.render(cold, {}, options, "overview");
    const auto kept = fresh.render(hot, {}, options, "overview");
    options.color_range = {{300.0, 2000.0}}; // what the cold start asks for: 1.2 times 1623 K, rounded up
    EXPECT_LT(difference(kept, fresh.render(hot, {}, options, "overview")), 0.01);
    options.color_range = {{800.0, 2000.0}};
    EXPECT_GT(difference(kept, fresh.render(hot, {}, options, "overview")), 0.5);
}

TEST_F(Pictures, odd_small_and_large_sizes_come_out_as_asked) {
    for (const std::array<int, 2> size : {std::array{333, 251}, std::array{64, 64}, std::array{2500, 1400}}) {
        options.size = size;
        const auto image = picture("overview", 300e-6);
        EXPECT_EQ(image->GetDimensions()[0], size[0]);
        EXPECT_EQ(image->GetDimensions()[1], size[1]);
        EXPECT_GT(color_count(image), 50U);
    }
}

TEST_F(Pictures, other_fields_backgrounds_and_maps_show) {
    const auto reference = picture("overview", 300e-6);
    options.background = Background::light;
    EXPECT_GT(difference(reference, picture("overview", 300e-6)), 50.0);
    options.background = Background::dark;
    for (const std::string& map : colormap_names()) {
        options.colormap = map;
        EXPECT_GT(color_count(picture("top", 300e-6)), 300U) << map;
    }
    for (const std::string& field : field_names()) {
        options.field = field;
        EXPECT_GT(color_count(picture("section", 300e-6)), 50U) << field;
    }
}

TEST_F(Pictures, an_empty_domain_and_no_laser_can_be_shown) {
    auto snapshot = test::make_snapshot(plate, 0.0);
    snapshot->beams.clear();
    snapshot->pools.clear();
    snapshot->phi = std::make_shared<const std::vector<double>>(snapshot->phi->size(), 1.0);
    std::shared_ptr<const Geometry> geometry;
    const Instant instant = make_instant(snapshot, geometry);
    for (const std::string& view : view_names()) {
        EXPECT_NO_THROW(renderer->render(instant, {}, options, view)) << view;
    }
}

TEST_F(Pictures, moves_without_light_are_seen_but_fainter_than_scanned_lines) {
    const auto with_path = [&](const std::vector<PathCorner>& done, const std::vector<PathCorner>& to_come) {
        auto snapshot = test::make_snapshot(plate, 300e-6);
        snapshot->beams.front().path_done = done;
        snapshot->beams.front().path_to_come = to_come;
        std::shared_ptr<const Geometry> geometry;
        return renderer->render(make_instant(snapshot, geometry), {}, options, "top");
    };
    const Vec3 from(0.3e-3, 0.15e-3, 0.0), to(1.5e-3, 0.15e-3, 0.0); // beside the pool
    const auto none = with_path({}, {});
    const auto seen = [&](bool lit, bool done) {
        const std::vector<PathCorner> line{{from}, {to, lit}};
        return difference(none, done ? with_path(line, {}) : with_path({}, line));
    };
    for (const bool done : {true, false}) {
        EXPECT_GT(seen(false, done), 0.05 * seen(true, done)) << done;
        EXPECT_LT(seen(false, done), 0.5 * seen(true, done)) << done;
    }
    EXPECT_LT(seen(true, false), 0.7 * seen(true, true)) << "what is to come is dashed";
    EXPECT_LT(seen(false, false), 0.7 * seen(false, true));
}

TEST_F(Pictures, png_keeps_picture_and_time) {
    const test::ScratchFolder scratch;
    const auto image = picture("overview", 300e-6);
    const auto path = scratch.path() / "a.png";
    write_png(image, path, 1.0 / 3.0);
    EXPECT_EQ(png_time(path), 1.0 / 3.0);
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    EXPECT_EQ(difference(reader->GetOutput(), image), 0.0);
    EXPECT_THROW(write_png(image, scratch.path() / "nowhere" / "a.png", 0.0), VizError);
}

TEST_F(Pictures, movies_of_odd_sizes_and_gaps_are_made) {
    if (!find_program("ffmpeg")) {
        GTEST_SKIP() << "no ffmpeg";
    }
    const test::ScratchFolder scratch;
    options.size = {333, 251};
    const auto image = picture("overview", 300e-6);
    for (const char* name : {"overview_000000.png", "overview_000001.png", "overview_000005.png"}) {
        write_png(image, scratch.path() / name, 0.0);
    }
    EXPECT_EQ(views_with_frames(scratch.path()), std::vector<std::string>{"overview"});
    const auto movie = scratch.path() / "overview.mp4";
    EXPECT_TRUE(encode_movie(scratch.path(), "overview", movie));
    EXPECT_GT(std::filesystem::file_size(movie), 1000U);
    EXPECT_FALSE(encode_movie(scratch.path(), "section", scratch.path() / "section.mp4"));
    const auto ffprobe = find_program("ffprobe");
    ASSERT_TRUE(ffprobe);
    Child probe({"/bin/sh", "-c",
                 "exec " + ffprobe->string() +
                     " -v error -count_frames -show_entries "
                     "stream=codec_name,width,height,pix_fmt,nb_read_frames -of csv " +
                     movie.string() + " >&2"});
    EXPECT_EQ(probe.read_all(), "stream,h264,334,252,yuv420p,3\n");
}

TEST(Movie, without_ffmpeg_or_with_broken_pictures_the_reason_is_told) {
    const test::ScratchFolder scratch;
    EXPECT_FALSE(encode_movie(scratch.path(), "overview", scratch.path() / "a.mp4"));
    std::FILE* file = std::fopen((scratch.path() / "overview_000000.png").c_str(), "w");
    std::fputs("no picture", file);
    std::fclose(file);
    EXPECT_THROW(encode_movie(scratch.path(), "overview", scratch.path() / "a.mp4"), VizError);
    EXPECT_FALSE(std::filesystem::exists(scratch.path() / "a.mp4"));
    const test::ScopedVariable no_programs("PATH", "/nonexistent");
    try {
        encode_movie(scratch.path(), "overview", scratch.path() / "a.mp4");
        FAIL() << "a movie without ffmpeg";
    } catch (const VizError& error) {
        EXPECT_NE(std::string(error.what()).find("ffmpeg"), std::string::npos);
    }
}

} // namespace
} // namespace meltscope::viz

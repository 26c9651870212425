#include "viz/colors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace meltscope::viz {

namespace {

struct ColorMap {
    const char* name;
    std::array<std::uint32_t, 33> rgb; ///< evenly spaced
};

// Sampled from the perceptually uniform maps of S. van der Walt and N. Smith (2015, CC0) and from cividis of
// J. Nunez, C. Anderton and R. Renslow (2018, doi:10.1371/journal.pone.0199239, CC0).
constexpr std::array<ColorMap, 5> color_maps{{
    {"inferno", {0x000004, 0x040312, 0x0b0724, 0x150b37, 0x210c4a, 0x2f0a5b, 0x3d0965, 0x4a0c6b, 0x57106e,
                 0x64156e, 0x71196e, 0x7d1e6d, 0x8a226a, 0x972766, 0xa32c61, 0xb0315b, 0xbc3754, 0xc73e4c,
                 0xd24644, 0xdb503b, 0xe45a31, 0xeb6628, 0xf1731d, 0xf68013, 0xf98e09, 0xfb9d07, 0xfcac11,
                 0xfbbc21, 0xf9cb35, 0xf5db4c, 0xf2ea69, 0xf3f68a, 0xfcffa4}},
    {"magma", {0x000004, 0x030312, 0x0a0822, 0x130d34, 0x1d1147, 0x29115a, 0x36106b, 0x440f76, 0x51127c,
               0x5d177f, 0x6a1c81, 0x762181, 0x832681, 0x902a81, 0x9c2e7f, 0xaa337d, 0xb73779, 0xc43c75,
               0xd0416f, 0xdc4869, 0xe75263, 0xef5d5e, 0xf56b5c, 0xf9795d, 0xfc8961, 0xfd9869, 0xfea772,
               0xfeb67c, 0xfec488, 0xfed395, 0xfde2a3, 0xfcf0b2, 0xfcfdbf}},
    {"plasma", {0x0d0887, 0x220690, 0x310597, 0x3f049c, 0x4c02a1, 0x5901a5, 0x6600a7, 0x7201a8, 0x7e03a8,
                0x8a09a5, 0x9511a1, 0xa01a9c, 0xaa2395, 0xb32c8e, 0xbc3587, 0xc43e7f, 0xcc4778, 0xd35171,
                0xda5a6a, 0xe06363, 0xe66c5c, 0xeb7655, 0xf0804e, 0xf58b47, 0xf89540, 0xfba139, 0xfdac33,
                0xfeb82c, 0xfdc527, 0xfcd225, 0xf8df25, 0xf4ed27, 0xf0f921}},
    {"viridis", {0x440154, 0x470d60, 0x48186a, 0x482374, 0x472d7b, 0x453781, 0x424086, 0x3e4989, 0x3b528b,
                 0x375b8d, 0x33638d, 0x2f6b8e, 0x2c728e, 0x297a8e, 0x26828e, 0x23898e, 0x21918c, 0x1f988b,
                 0x1fa088, 0x22a785, 0x28ae80, 0x32b67a, 0x3fbc73, 0x4ec36b, 0x5ec962, 0x70cf57, 0x84d44b,
                 0x98d83e, 0xaddc30, 0xc2df23, 0xd8e219, 0xece51b, 0xfde725}},
    {"cividis", {0x00224e, 0x00285b, 0x002e6a, 0x053371, 0x1a386f, 0x273e6e, 0x32436d, 0x3b496c, 0x434e6c,
                 0x4b546c, 0x535a6d, 0x5a5f6e, 0x61656f, 0x686a71, 0x6f7073, 0x767676, 0x7d7c78, 0x848279,
                 0x8c8878, 0x938e78, 0x9b9476, 0xa39a74, 0xaba072, 0xb4a76f, 0xbcae6c, 0xc4b468, 0xcdbb63,
                 0xd5c25e, 0xdec958, 0xe7d150, 0xf0d846, 0xf9e03a, 0xfee838}},
}};

Rgb unpack(std::uint32_t rgb) {
    return {static_cast<double>((rgb >> 16U) & 255U) / 255.0, static_cast<double>((rgb >> 8U) & 255U) / 255.0,
            static_cast<double>(rgb & 255U) / 255.0};
}

double luminance(const Rgb& color) {
    return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
}

constexpr double darkest = 0.17; // luminance

} // namespace

const std::vector<std::string>& colormap_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        for (const ColorMap& map : color_maps) {
            list.emplace_back(map.name);
        }
        return list;
    }();
    return names;
}

const Theme& theme(Background background) {
    static const Theme dark{
        unpack(0x0e1014), unpack(0xf0f1f3),
        unpack(0x9aa1ad), unpack(0x3a404b),
        unpack(0xffffff), unpack(0xc4cad4),
        unpack(0x7fc4ff), unpack(0x7fc4ff),
        unpack(0x45f0df), {unpack(0x7fc4ff), unpack(0xffb454), unpack(0x8fe388), unpack(0xff7d90)}};
    static const Theme light{
        unpack(0xffffff), unpack(0x16181d),
        unpack(0x5d6470), unpack(0xd0d4da),
        unpack(0xffffff), unpack(0xc4cad4),
        unpack(0x5fb0f5), unpack(0x5fb0f5),
        unpack(0x14d8c4), {unpack(0x1f6fb8), unpack(0xc26a00), unpack(0x2e8b3d), unpack(0xc4304a)}};
    return background == Background::dark ? dark : light;
}

vtkSmartPointer<vtkLookupTable> make_lookup_table(const std::string& colormap,
                                                  const std::array<double, 2>& range) {
    const auto map = std::find_if(color_maps.begin(), color_maps.end(),
                                  [&](const ColorMap& candidate) { return candidate.name == colormap; });
    if (map == color_maps.end()) {
        throw VizError("there is no colour map '" + colormap + "'");
    }
    constexpr int colors = 256;
    auto table = vtkSmartPointer<vtkLookupTable>::New();
    table->SetNumberOfTableValues(colors);
    table->SetTableRange(range[0], range[1]);
    table->SetNanColor(0.5, 0.5, 0.5, 1.0);
    // Cold material is not quite black, so that light and shade show its form; the order of brightness stays.
    const double lift = std::max(0.0, darkest - luminance(unpack(map->rgb.front())));
    for (int i = 0; i < colors; ++i) {
        const double position = 32.0 * i / (colors - 1);
        const auto left = static_cast<std::size_t>(std::min(31.0, std::floor(position)));
        const double weight = position - static_cast<double>(left);
        const Rgb a = unpack(map->rgb.at(left));
        const Rgb b = unpack(map->rgb.at(left + 1));
        Rgb color{};
        for (std::size_t channel = 0; channel < 3; ++channel) {
            color.at(channel) = a.at(channel) + weight * (b.at(channel) - a.at(channel));
        }
        const double added = lift * std::pow(1.0 - luminance(color), 3);
        for (double& channel : color) {
            channel = std::min(1.0, channel + added);
        }
        table->SetTableValue(i, color[0], color[1], color[2], 1.0);
    }
    return table;
}

} // namespace meltscope::viz

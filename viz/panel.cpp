#include "viz/panel.hpp"

#include "viz/annotations.hpp"

#include "meltscope/constants.hpp"

#include <algorithm>
#include <cmath>

#include <vtkLight.h>
#include <vtkMatrix4x4.h>

namespace meltscope::viz {

HistoryPoint history_point(const Snapshot& snapshot) {
    HistoryPoint point;
    point.time = snapshot.time;
    const PoolFigures pool = shown_pool(snapshot);
    point.length = pool.length;
    point.width = pool.width;
    point.depth = pool.depth;
    for (const BeamSnapshot& beam : snapshot.beams) {
        point.power += beam.on ? beam.power : 0.0;
    }
    point.peak = snapshot.peak_temperature;
    return point;
}

PoolFigures shown_pool(const Snapshot& snapshot) {
    const BeamSnapshot* beam = leading_beam(snapshot);
    if (beam != nullptr && !beam->pools.empty() && beam->pools.front().length > 0.0) {
        return beam->pools.front();
    }
    if (snapshot.pools.empty()) {
        return {};
    }
    const auto largest = std::find_if(
        snapshot.separate_pools.begin(), snapshot.separate_pools.end(),
        [&](const SeparatePool& pool) { return pool.figures.isotherm == snapshot.pools.front().isotherm; });
    return largest != snapshot.separate_pools.end() ? largest->figures : snapshot.pools.front();
}

const BeamSnapshot* leading_beam(const Snapshot& snapshot) {
    const auto on = std::find_if(snapshot.beams.begin(), snapshot.beams.end(),
                                 [](const BeamSnapshot& beam) { return beam.on && beam.power > 0.0; });
    if (on != snapshot.beams.end()) {
        return &*on;
    }
    return snapshot.beams.empty() ? nullptr : &snapshot.beams.front();
}

Vec3 spot_center(const BeamSnapshot& beam, const Geometry& geometry) {
    Vec3 center = beam.position;
    if (std::abs(beam.beam_direction.z()) > 0.9) {
        center.z() = geometry.heights.at(center.x(), center.y()).value_or(center.z());
    }
    return center;
}

Vec3 track_direction(const BeamSnapshot* beam) {
    return beam == nullptr ? Vec3(Vec3::UnitX()) : level_direction(*beam);
}

Panel::Panel() {
    renderer_->SetLayer(1);
    // Smooths edges at a fifth of the cost of multisampling with a software renderer.
    renderer_->UseFXAAOn();
    renderer_->InteractiveOff();
    renderer_->AutomaticLightCreationOff();
    // Fixed to the scene: from above, a little from the front left, so that faces turned up are the
    // brightest.
    vtkNew<vtkLight> light;
    light->SetLightTypeToSceneLight();
    light->SetPosition(-0.35, -0.45, 1.0);
    light->SetFocalPoint(0.0, 0.0, 0.0);
    light->SetIntensity(1.15);
    renderer_->AddLight(light);
}

void Panel::place(const Picture& picture, const Rect& area) {
    const double width = picture.size[0];
    const double height = picture.size[1];
    renderer_->SetViewport(area.x / width, area.y / height, (area.x + area.width) / width,
                           (area.y + area.height) / height);
}

Rect Panel::above_scale_bar(const Picture& picture, const Rect& area) {
    const double strip = picture.heading > 0.0 ? 0.0 : 2.2 * picture.font;
    return {area.x, area.y + strip, area.width, area.height - strip};
}

void Panel::place_scale_bar(const Picture& picture, const Rect& area, const Pixel& in_strip,
                            double pixels_per_metre, Canvas& canvas) {
    Pixel left = in_strip;
    if (picture.heading > 0.0) {
        left = {area.x + 0.6 * area.width, area.y + area.height + 0.5 * picture.heading};
    }
    draw_scale_bar(canvas, picture, left, pixels_per_metre, 0.25 * area.width);
}

Pixel Panel::to_pixel(const Picture&, const Rect& area, const Vec3& point) {
    // The matrix is asked for with the panel's own aspect: the renderer's is not known before it has
    // rendered.
    vtkMatrix4x4* matrix = renderer_->GetActiveCamera()->GetCompositeProjectionTransformMatrix(
        area.width / area.height, -1.0, 1.0);
    const double in[4] = {point.x(), point.y(), point.z(), 1.0};
    double out[4];
    matrix->MultiplyPoint(in, out);
    return {area.x + 0.5 * (1.0 + out[0] / out[3]) * area.width,
            area.y + 0.5 * (1.0 + out[1] / out[3]) * area.height};
}

void fit_camera(vtkCamera* camera, const std::vector<Vec3>& points, const Vec3& direction, const Vec3& up,
                double aspect) {
    constexpr double view_angle = 18.0; // degrees; narrow, so that parallel edges look parallel
    const double half_height = std::tan(0.5 * view_angle * constants::pi / 180.0);
    const double half_width = half_height * aspect;
    const Vec3 forward = direction.normalized();
    const Vec3 right = forward.cross(up).normalized();
    const Vec3 above = right.cross(forward);
    Vec3 center = Vec3::Zero();
    for (const Vec3& point : points) {
        center += point / static_cast<double>(points.size());
    }
    double radius = 0.0;
    for (const Vec3& point : points) {
        radius = std::max(radius, (point - center).norm());
    }
    double distance = 2.0 * radius / half_height;
    for (int iteration = 0; iteration < 60; ++iteration) {
        double low_x = 1e30, high_x = -1e30, low_y = 1e30, high_y = -1e30;
        for (const Vec3& point : points) {
            const Vec3 offset = point - center;
            const double depth = std::max(distance + offset.dot(forward), 1e-3 * radius);
            low_x = std::min(low_x, offset.dot(right) / (depth * half_width));
            high_x = std::max(high_x, offset.dot(right) / (depth * half_width));
            low_y = std::min(low_y, offset.dot(above) / (depth * half_height));
            high_y = std::max(high_y, offset.dot(above) / (depth * half_height));
        }
        center += 0.5 * (low_x + high_x) * distance * half_width * right +
                  0.5 * (low_y + high_y) * distance * half_height * above;
        distance *= 0.5 * (1.0 + 0.5 * std::max(high_x - low_x, high_y - low_y));
    }
    const Vec3 position = center - distance * forward;
    camera->ParallelProjectionOff();
    camera->SetViewAngle(view_angle);
    camera->SetFocalPoint(center.data());
    camera->SetPosition(position.data());
    camera->SetViewUp(up.data());
    camera->SetClippingRange(std::max(distance - 1.5 * radius, 0.02 * distance), distance + 1.5 * radius);
}

} // namespace meltscope::viz

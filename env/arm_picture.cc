#include "env/arm_picture.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "data/base/error.h"
#include "robot_model/arm_model.h"

namespace sandwright {
namespace {

[[noreturn]] void NoEgl(const std::string& step) {
  throw Error(fmt::format(
      "no picture of the arm: {} failed (EGL error {:#x}); it needs EGL, for example Debian's "
      "libegl1 and libgl1-mesa-dri",
      step, eglGetError()));
}

// An OpenGL context without a window, current on this thread while it lives.
class EglContext {
 public:
  EglContext() {
    const auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (get_display)
      display_ = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display_ == EGL_NO_DISPLAY) display_ = eglGetDisplay(EGL_DEFAULT_DISPLAY);
    if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr))
      NoEgl("eglInitialize");
    const EGLint wanted[] = {EGL_RED_SIZE,
                             8,
                             EGL_GREEN_SIZE,
                             8,
                             EGL_BLUE_SIZE,
                             8,
                             EGL_DEPTH_SIZE,
                             24,
                             EGL_SURFACE_TYPE,
                             EGL_PBUFFER_BIT,
                             EGL_RENDERABLE_TYPE,
                             EGL_OPENGL_BIT,
                             EGL_NONE};
    EGLConfig config;
    EGLint count = 0;
    if (!eglChooseConfig(display_, wanted, &config, 1, &count) || count == 0)
      Fail("eglChooseConfig");
    if (!eglBindAPI(EGL_OPENGL_API)) Fail("eglBindAPI");
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
    if (context_ == EGL_NO_CONTEXT) Fail("eglCreateContext");
    if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) Fail("eglMakeCurrent");
  }
  ~EglContext() { Close(); }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

 private:
  void Close() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
    eglTerminate(display_);
  }
  [[noreturn]] void Fail(const char* step) {
    const std::string text = step;
    Close();
    NoEgl(text);
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

// Looks at the box from the side away from the arm, a little from above.
mjvCamera CameraOnBox(const Workcell& workcell) {
  const Eigen::Isometry3d X_WB = workcell.X_WB.ToIsometry();
  const Eigen::Vector3d middle =
      X_WB * Eigen::Vector3d(workcell.box.width_m / 2, workcell.box.depth_m / 2,
                             workcell.box.wall_height_m);
  const Eigen::Vector3d aim = 0.72 * middle + Eigen::Vector3d(0, 0, 0.18);
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.type = mjCAMERA_FREE;
  for (int i = 0; i < 3; ++i) camera.lookat[i] = aim[i];
  camera.distance = 0.75 + 1.2 * std::max(workcell.box.width_m, middle.norm());
  // Towards the base, 35 degrees off the line to the box: blade, camera and furrow stay in sight.
  camera.azimuth = std::atan2(-middle.y(), -middle.x()) * 180 / 3.14159265358979 - 35;
  camera.elevation = -30;
  return camera;
}

}  // namespace

struct ArmPicture::Impl {
  Impl(const Workcell& workcell, const HeightMap& terrain, int width_px, int height_px)
      : viewport{0, 0, width_px, height_px},
        model(MakeArmModel(workcell, &terrain)),
        data(MakeArmData(*model)),
        camera(CameraOnBox(workcell)) {
    model->vis.global.offwidth = width_px;
    model->vis.global.offheight = height_px;
    model->vis.quality.offsamples = 4;
    model->vis.quality.numslices = 64;
    model->vis.quality.shadowsize = 8192;
    std::ranges::fill(model->vis.headlight.ambient, 0.35f);  // what lies in the shadow is seen too
    std::ranges::fill(model->vis.headlight.specular, 0.1f);
    mjv_defaultOption(&option);
    mjv_defaultScene(&scene);
    mjr_defaultContext(&context);
    mjv_makeScene(model.get(), &scene, 200);
    mjr_makeContext(model.get(), &context, mjFONTSCALE_100);
    mjr_setBuffer(mjFB_OFFSCREEN, &context);
  }
  ~Impl() {
    mjr_freeContext(&context);
    mjv_freeScene(&scene);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  EglContext egl;  // first made, last gone
  mjrRect viewport;
  MujocoModel model;
  MujocoData data;
  mjvCamera camera;
  mjvOption option;
  mjvScene scene;
  mjrContext context;
};

ArmPicture::ArmPicture(const Workcell& workcell, const HeightMap& terrain, int width_px,
                       int height_px) {
  SAND_CHECK(width_px > 0 && height_px > 0, width_px, height_px);
  // MuJoCo finds its drawing functions through the library that this names; a user's choice stays.
  setenv("MUJOCO_GL", "egl", 0);
  impl_ = std::make_unique<Impl>(workcell, terrain, width_px, height_px);
}

ArmPicture::~ArmPicture() = default;

cv::Mat ArmPicture::Draw(const JointAngles& q) {
  SetJoints(*impl_->model, q, *impl_->data);
  mj_forward(impl_->model.get(), impl_->data.get());
  mjv_updateScene(impl_->model.get(), impl_->data.get(), &impl_->option, nullptr, &impl_->camera,
                  mjCAT_ALL, &impl_->scene);
  mjr_render(impl_->viewport, &impl_->scene, &impl_->context);
  cv::Mat picture(impl_->viewport.height, impl_->viewport.width, CV_8UC3);
  mjr_readPixels(picture.data, nullptr, impl_->viewport, &impl_->context);
  cv::flip(picture, picture, 0);
  cv::cvtColor(picture, picture, cv::COLOR_RGB2BGR);
  return picture;
}

}  // namespace sandwright

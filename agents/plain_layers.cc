#include "agents/plain_layers.h"

namespace sandwright {

PlainRows PlainLinear(const torch::nn::Linear& layer, const PlainRows& rows) {
  const int64_t outputs = layer->weight.size(0), inputs = layer->weight.size(1);
  const Eigen::Map<const PlainRows> weight(layer->weight.data_ptr<float>(), outputs, inputs);
  const Eigen::Map<const Eigen::RowVectorXf> bias(layer->bias.data_ptr<float>(), outputs);
  PlainRows out(rows.rows(), outputs);
  // Row by row: a product of a matrix and a vector, which a row's neighbours cannot change.
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    out.row(i).noalias() = rows.row(i) * weight.transpose();
  out.rowwise() += bias;
  return out;
}

PlainRows PlainTanhLayers(const torch::nn::Linear& in, const torch::nn::Linear& hidden,
                          const PlainRows& rows) {
  const PlainRows first = PlainLinear(in, rows).array().tanh();
  return PlainLinear(hidden, first).array().tanh();
}

}  // namespace sandwright

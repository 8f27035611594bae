/// TODO
pub struct Covariance;

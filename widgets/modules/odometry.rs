widgets::module!(widgets::odometry::Assembled);

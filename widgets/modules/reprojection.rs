widgets::module!(widgets::reprojection::Reprojection);
